import { describe, expect, test } from "vitest";
import type { Event, HistoryEntry, Phase } from "../../model/generated/protocol.ts";
import { isConcurrent } from "../../model/machine.ts";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { Journal } from "../history/journal.ts";
import { RecentPath } from "../history/recent_path.ts";
import type { Active } from "./active.ts";
import { failedStates, stateMarks, transitionOf } from "./marks.ts";

const MACHINE = machineOf(
  sketch(`
R hierarchy 0 0 400 300 outcome done
  A execution 20 20 80 60 outcome ok
  B execution 200 20 80 60 outcome ok
  C barrier 20 120 300 160 outcome ok
    X hierarchy 10 10 100 80 outcome ok
      U execution 10 10 40 30 outcome ok
      X > U
      U.ok > X.ok
    Y execution 150 10 80 60 outcome ok
  R > A
  A.ok > B
  B.ok > C
  C.ok > R.done
`),
);

/** Events as words: `>A` is an entry, `<A` an end with `ok`, `<A:-1` an end with another outcome, `!` at the end a step back. */
function journal(text: string): Journal {
  const found = new Journal();
  const entries: HistoryEntry[] = text
    .trim()
    .split(/\s+/)
    .map((word, index) => ({ sequence: index + 1, t_ns: index, event: eventOf(word) }));
  found.add(entries, entries.length + 1);
  return found;
}

function eventOf(word: string): Event {
  const isBack = word.endsWith("!");
  const [path = "", id = "0"] = word.slice(1, isBack ? -1 : undefined).split(":");
  const undoes = isBack ? 1 : null;
  return word.startsWith(">")
    ? { type: "entered", path, undoes }
    : { type: "left", path, undoes, outcome: { id: Number(id), name: "" } };
}

function recentPathOf(text: string): RecentPath {
  const recentPath = new RecentPath((path) => {
    const state = MACHINE.state(path);
    return state !== undefined && isConcurrent(state);
  });
  const recorded = journal(text);
  recentPath.follow(recorded, recorded.length);
  return recentPath;
}

/** Past states and transitions with their age. */
function pathInWords(recentPath: RecentPath): string {
  return recentPath
    .past()
    .map(({ path, taken, age, goal }) => {
      const line = taken && transitionOf(MACHINE, taken, goal);
      return `${age} ${[path, line?.replace("transition:", "")].filter(Boolean).join(" ")}`;
    })
    .join("\n");
}

const active = (path: string, phase: Phase = "running", next?: string): Active => ({
  path,
  name: path,
  phase,
  since_ms: 2_500,
  branch: "",
  detail: null,
  held: next ? [{ next, by: { type: "step" } }] : [],
});

const START = transitionOf(MACHINE, { container: "R", from: null, outcome: 0 }) ?? "";
const AB = transitionOf(MACHINE, { container: "R", from: "R/A", outcome: 0 }) ?? "";

test("states that ended and transitions that were taken stay for a while", () => {
  const found = pathInWords(recentPathOf(">R >R/A <R/A >R/B <R/B"));
  expect(found).toBe(
    [START, "R/A", AB, "R/B"]
      .map((what, index) => `${[2, 1, 1, 0][index]} ${what.replace("transition:", "")}`)
      .join("\n"),
  );
});

test("a transition is not taken where the run continued elsewhere", () => {
  const jump = pathInWords(recentPathOf(">R >R/A <R/A >R/C"));
  expect(jump).toBe(`1 ${START.replace("transition:", "")}\n0 R/A\n0 `);
  const stopped = pathInWords(recentPathOf(">R >R/A <R/A <R:-2"));
  expect(stopped.split("\n").at(-1)).toBe("0 R");
  const done = pathInWords(recentPathOf(">R >R/C <R/C <R"));
  expect(done.split("\n").at(-1)).toBe("0 R R:3");
});

test("each branch has its own way, and what ended of it stays in the one around", () => {
  const inside = ">R >R/C >R/C/X >R/C/Y >R/C/X/U <R/C/X/U";
  const recentPath = recentPathOf(inside);
  expect(recentPath.branch("R/C/X/U")).toBe("R/C/X");
  expect(pathInWords(recentPath)).toContain("0 R/C/X/U");
  expect(pathInWords(recentPathOf(`${inside} <R/C/X <R/C/Y <R/C`))).toMatch(/1 R\/C\/Y\n0 R\/C$/);
});

test("no more than a dozen steps stay", () => {
  const loop = Array.from({ length: 40 }, () => ">R/A <R/A").join(" ");
  const ages = recentPathOf(`>R ${loop}`).past();
  expect(Math.max(...ages.map(({ age }) => age))).toBe(11);
});

test("a step back takes the last step away", () => {
  const recentPath = recentPathOf(">R >R/A <R/A >R/B <R/B >R/B! <R/B!");
  expect(pathInWords(recentPath)).toBe(`1 ${START.replace("transition:", "")}\n0 R/A`);
  expect(nextLine(recentPath, "R", "R/B")).toBe(AB);
});

test("where a held branch goes next is its transition, if that leads there", () => {
  const recentPath = recentPathOf(">R >R/A <R/A");
  expect(nextLine(recentPath, "R", "R/B")).toBe(AB);
  expect(nextLine(recentPath, "R", "R/C")).toBe(null);
});

/** The transition from the container's current position to a child. */
function nextLine(recentPath: RecentPath, container: string, next: string): string | null {
  const from = recentPath.from(container);
  return from && transitionOf(MACHINE, from, next);
}

describe("where a container continues from", () => {
  const times = (count: number, words: string) => Array(count).fill(words).join(" ");
  const from = (text: string) => {
    const found = recentPathOf(text).from("R");
    return found && (found.from ?? "start");
  };

  test("is unknown after 64 steps back over more ends, until a child ends", () => {
    const back = (ends: number, steps: number) =>
      `>R ${times(ends, ">R/A <R/A")} ${times(steps, ">R/A! <R/A!")}`;
    expect(from(back(64, 63))).toBe("R/A");
    expect(from(back(64, 64))).toBe("start");
    expect(from(back(65, 63))).toBe("R/A");
    expect(from(back(65, 64))).toBe(null);
    expect(from(`${back(65, 64)} >R/B <R/B`)).toBe("R/B");
    expect(from(`${back(65, 64)} >R/B <R/B >R/B! <R/B!`)).toBe(null);
  });

  test("is unknown where its entry lies before what is known", () => {
    expect(from(">R/A")).toBe(null);
    expect(from(">R/A <R/A")).toBe("R/A");
    expect(from(">R/A <R/A >R/A! <R/A!")).toBe(null);
  });

  test("is unknown in an earlier visit, to which the steps back lead", () => {
    const visit = ">R >R/A <R/A >R/B <R/B <R";
    expect(from(`${visit} >R!`)).toBe("R/B");
    expect(from(`${visit} >R <R! >R!`)).toBe(null);
  });

  test("marks no start line in the trail where that is unknown", () => {
    expect(pathInWords(recentPathOf(">R >R/A"))).toBe(`0 ${START.replace("transition:", "")}`);
    expect(pathInWords(recentPathOf(">R/A"))).toBe("0 ");
  });
});

const written = (marks: ReturnType<typeof stateMarks>) =>
  [...marks]
    .sort(([one], [other]) => (one < other ? -1 : 1))
    .map(([path, { phase, mostUrgent, isLeaf, lanes, age, failed }]) =>
      [path, phase, mostUrgent !== phase && mostUrgent, isLeaf && "leaf", lanes > 0 && lanes]
        .concat([age > 0 && `age ${age}`, failed && "failed"])
        .filter((word) => word !== false)
        .join(" "),
    )
    .join("\n");

test("what runs is louder than what ran, and containers tell what runs inside", () => {
  const recentPath = recentPathOf(">R >R/A <R/A >R/B");
  const marks = stateMarks([active("R"), active("R/B")], recentPath, new Set());
  expect(written(marks)).toBe("R running 1\nR/A trail\nR/B running leaf");
  expect(marks.get("R/B")?.since_ms).toBe(2_500);
});

test("what ended because it was preempted says so", () => {
  const marks = stateMarks([], recentPathOf(">R >R/A <R/A:-2"), new Set());
  expect(marks.get("R/A")).toMatchObject({ phase: "trail", preempted: true });
});

test("a held branch shows which state comes next", () => {
  const marks = stateMarks([active("R", "held", "R/B")], recentPathOf(">R >R/A <R/A"), new Set());
  expect(written(marks)).toBe("R held leaf\nR/A trail\nR/B next");
});

test("what waits is told around it, whatever failed there before", () => {
  const all = [active("R"), active("R/C"), active("R/C/X", "waiting"), active("R/C/Y")];
  const marks = stateMarks(all, recentPathOf(">R"), new Set(["R/C/X/U", "R/C"]));
  const around = ["R", "R/C", "R/C/X", "R/C/Y"].map((path) => marks.get(path)?.mostUrgentActive);
  expect(around).toEqual(["waiting", "waiting", "waiting", "running"]);
  expect(marks.get("R")?.mostUrgent).toBe("failed");
});

test("around a branch that waits all waits, unless something beside it is at work", () => {
  const phases = (...all: readonly Active[]) => {
    const marks = stateMarks(all, recentPathOf(">R"), new Set());
    return all.map(({ path }) => `${path} ${marks.get(path)?.phase}`);
  };
  const waits = active("R/C/X", "waiting");
  expect(phases(active("R"), active("R/C"), waits)).toEqual([
    "R waiting",
    "R/C waiting",
    "R/C/X waiting",
  ]);
  expect(phases(active("R"), active("R/C"), waits, active("R/C/Y"))).toEqual([
    "R running",
    "R/C running",
    "R/C/X waiting",
    "R/C/Y running",
  ]);
});

test("what failed is told around it too, also while it runs again", () => {
  const marks = stateMarks(
    [active("R"), active("R/C"), active("R/C/X"), active("R/C/X/U"), active("R/C/Y")],
    recentPathOf(">R"),
    new Set(["R/C/X/U"]),
  );
  expect(written(marks)).toBe(
    [
      "R running failed 2",
      "R/C running failed 2",
      "R/C/X running failed 1",
      "R/C/X/U running failed leaf failed",
      "R/C/Y running leaf",
    ].join("\n"),
  );
});

test("an abort that climbed marks every state on its way, until its event", () => {
  const failure = { kind: "aborted", path: "R/C/X", reach: "R/C", sequence: 5, first: 5 } as const;
  const open = [{ ...failure, level: "error", t_ns: 0, text: "", count: 1 }] as const;
  expect([...failedStates(open, 9).keys()]).toEqual(["R/C/X", "R/C"]);
  expect([...failedStates(open, 4).keys()]).toEqual([]);
});
