import { describe, expect, test } from "vitest";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { sinceStart } from "../../store/page/times.ts";
import { MODES } from "../../store/page/view.ts";
import type { RunMark } from "../../store/run/marks.ts";
import { layoutTreeOf } from "../layout/layout_tree.ts";
import { NO_OVERLAY } from "../overlay.ts";
import { PLAIN, type SceneInput } from "./input.ts";
import { scene } from "./scene.ts";
import { listText } from "./testing/text.ts";

const MACHINE = machineOf(
  sketch(`
    R "Pick" hierarchy 0 0 400 300 outcome done
      A "Look" execution 40 60 100 90 outcome seen output pose:list
      B "Grasp" hierarchy 220 60 140 120 outcome held input pose:list input force:int=3
        C "Close" execution 30 40 60 50 outcome ok
        B > C
      R > A
      A.seen > B
  `),
);

const MARK: RunMark = {
  phase: "running",
  mostUrgent: "running",
  mostUrgentActive: "running",
  isLeaf: true,
  lanes: 0,
  age: 0,
  since_ms: null,
  preempted: false,
  failed: false,
  detail: null,
};

type Marked = Readonly<Record<string, Partial<RunMark>>>;

/** What is drawn with these marks, about a state or line. */
function about(words: string, marked: Marked, scale = 1, more: Partial<SceneInput> = {}) {
  const layout = layoutTreeOf(MACHINE, { modes: MODES, contents: new Map() });
  const runs = new Map(
    Object.entries(marked).map(([path, mark]) => {
      const phase = mark.phase ?? "running";
      return [path, { ...MARK, mostUrgent: phase, mostUrgentActive: phase, ...mark }] as const;
    }),
  );
  const list = scene({
    ...PLAIN,
    layout,
    camera: { x: 0, y: 0, scale },
    view: { width: 800, height: 600 },
    modes: MODES,
    overlay: NO_OVERLAY,
    measure: (text) => text.length * 6,
    runs,
    ...more,
  });
  return listText(list)
    .split("\n")
    .filter((line) => line.includes(words));
}

const shown = (marked: Marked, scale?: number, more?: Partial<SceneInput>) =>
  about("state:R/A run", marked, scale, more).join("\n");

describe("phases are told apart by colour, shape and word", () => {
  test("what runs glows, and says for how long and how often", () => {
    const text = shown({ "R/A": { since_ms: 64_000 } }, 1, {
      visits: () => 3,
      sinceSnapshot_ms: 1_200,
    });
    expect(text).toContain("run glow");
    expect(text).toContain("|running|");
    expect(text).toContain('"1:05 · 3×"');
  });

  test("what waits is dashed, what is held has a white ring, what comes next is dashed and white", () => {
    const waits = shown({ "R/A": { phase: "waiting", detail: "a child" } }, 2);
    expect(waits).toContain("dashed");
    expect(waits).toContain("icon state:R/A run waiting");
    expect(waits).toContain('"waits: a child"');
    expect(shown({ "R/A": { phase: "held" } })).toContain("icon state:R/A run held");
    const next = shown({ "R/A": { phase: "next", isLeaf: false } });
    expect(next).toContain("dashed");
    expect(next).toContain('"next"');
  });

  test("what is preempted is hatched, what failed has a cross", () => {
    expect(shown({ "R/A": { phase: "preempted" } })).toContain("run hatch");
    const failed = shown({ "R/A": { phase: "failed", isLeaf: false } });
    expect(failed).toContain("icon state:R/A run failed");
    expect(failed).toContain('"failed"');
  });

  test("what failed before and runs again says both", () => {
    const text = shown({ "R/A": { failed: true, mostUrgent: "failed", since_ms: 2_000 } }, 2);
    expect(text).toContain("icon state:R/A run running");
    expect(text).toContain("icon state:R/A run failed");
    expect(text).toContain('"failed · running · 2 s"');
  });

  test("what ended because it was preempted is dashed in its colour", () => {
    const text = shown({ "R/A": { phase: "trail", preempted: true } });
    expect(text).toContain("|preempted| dashed");
  });

  test("a failed state that one points at shows its error", () => {
    const more = {
      hovered: { kind: "state", path: "R/A" },
      errors: new Map([["R/A", "ValueError: no pose"]]),
    } as const;
    const failed = { "R/A": { phase: "failed", failed: true } } as const;
    expect(about("text value", failed, 1, more)).toEqual([
      expect.stringContaining('"ValueError: no pose" 52 172'),
    ]);
    expect(about("text value", failed, 1, { ...more, hovered: null })).toEqual([]);
  });

  test("a trail fades from step to step", () => {
    const alpha = (age: number) => shown({ "R/A": { phase: "trail", age } }).match(/\d+%/)?.[0];
    expect([alpha(0), alpha(6), alpha(11)]).toEqual([undefined, "60%", "27%"]);
  });
});

describe("the same at every size", () => {
  test("a box without room for signs is filled while it runs, and dashed while it waits", () => {
    const small = (mark: Partial<RunMark>) => about("state:R run", { R: mark }, 0.05).join();
    expect(small({})).toContain("running |running|");
    expect(small({ phase: "waiting" })).toContain("dashed");
  });

  test("states that are too small to be seen have the colour of the loudest inside", () => {
    const marks = { "R/B": { phase: "running", mostUrgent: "failed", isLeaf: false } } as const;
    expect(about("speck state:R/B", marks, 0.15)).toEqual([
      "1 speck state:R/B 33 9 21 18 aborted 45%",
    ]);
  });

  test("a closed container in which something waits shows that, whatever failed in it before", () => {
    const inside = { isLeaf: false, mostUrgent: "failed", mostUrgentActive: "waiting" } as const;
    const mark = { ...inside, since_ms: 2_000, failed: true };
    const text = about("state:R/B run", { "R/B": mark }, 0.7).join("\n");
    expect(text).toContain("icon state:R/B run waiting");
    expect(text).toContain("icon state:R/B run failed");
    const small = about("state:R run", { R: mark }, 0.05).join("\n");
    expect(small).toContain("|waiting| dashed");
    expect(small).not.toContain("aborted");
  });

  test("a closed container shows the loudest inside, and how many branches", () => {
    const marks = { "R/B": { isLeaf: false, mostUrgent: "waiting", lanes: 3 } } as const;
    const text = about("state:R/B run", marks, 0.7).join("\n");
    expect(text).toContain("icon state:R/B run waiting");
    expect(text).toContain('"3"');
  });
});

test("the transition that comes next is dashed and above all, one that was taken fades", () => {
  const line = MACHINE.state("R")?.transitions?.find((each) => each.from_state === "A");
  const key = `transition:R:${line?.id}`;
  const taken = (isNext: boolean, age: number) =>
    about(`line ${key}`, {}, 1, {
      taken: new Map([[key, { isNext, age, sequence: 1 }]]),
    }).join();
  expect(taken(true, 0)).toContain("held dashed");
  expect(taken(false, 0)).toContain("running");
  expect(taken(false, 5)).toContain("trail");
});

test("heat colours states whose content does not show", () => {
  const heat = new Map([
    ["R", 5],
    ["R/A", 2],
  ]);
  expect(about("box state:R ", {}, 1, { heat }).join()).toContain("shade0");
  expect(about("box state:R/A", {}, 1, { heat }).join()).toContain("heat2");
});

describe("values at ports", () => {
  const key = `input:R/B:${MACHINE.state("R/B")?.inputs?.[0]?.id}`;
  const values = new Map([[key, { short: "list ⟨9⟩", full: "1 2 3 4 5 6 7 8 9" }]]);

  test("are chips as soon as there is room, and stand behind names where both fit", () => {
    const long = new Map([[key, { short: "list of nine ⟨9⟩", full: "" }]]);
    const alone = about(`${key} name`, {}, 1, { values: long }).join();
    expect([alone.includes('"list'), alone.includes("pose")]).toEqual([true, false]);
    expect(about(`${key} name`, {}, 1, { values }).join()).toContain('"pose = list ⟨9⟩"');
    expect(about(`${key} name`, {}, 3, { values }).join()).toContain('"pose = list ⟨9⟩"');
    expect(about(`${key} name`, {}, 0.5, { values })).toEqual([]);
  });

  test("are never defaults while a run is shown", () => {
    const force = `input:R/B:${MACHINE.state("R/B")?.inputs?.[1]?.id} name`;
    expect(about(force, {}, 3).join()).toContain('"force = 3"');
    expect(about(force, { "R/A": {} }, 3).join()).toContain('"force"');
  });

  test("are told in full under the pointer", () => {
    const id = MACHINE.state("R/B")?.inputs?.[0]?.id ?? 0;
    const hovered = { kind: "input", path: "R/B", id } as const;
    expect(about("text value", {}, 1, { values, hovered }).join()).toContain("1 2 3 4 5 6 7 8 9");
  });
});

test("times are told short", () => {
  expect([5, 65, 3_725].map((seconds) => sinceStart(seconds * 1_000, 1_000))).toEqual([
    "5 s",
    "1:05",
    "1:02:05",
  ]);
});
