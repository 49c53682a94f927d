import { describe, expect, test } from "vitest";
import type { Machine } from "../../model/machine.ts";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { type Camera, MODES } from "../../store/page/view.ts";
import { layoutTreeOf } from "../layout/layout_tree.ts";
import { NO_OVERLAY } from "../overlay.ts";
import { PLAIN, type SceneInput } from "./input.ts";
import { scene } from "./scene.ts";
import { listText } from "./testing/text.ts";

const PICK = machineOf(
  sketch(`
    R "Pick a part" hierarchy 0 0 400 300 outcome done
      A "Look for the part" execution 40 60 100 80 outcome seen output pose:list
      B "Grasp it" hierarchy 220 60 140 120 outcome held input pose:list
        C "Close the gripper" execution 30 40 60 50 outcome ok
        B > C
        C.ok > B.held
      R > A
      A.seen > B
      A.aborted > R.aborted
      B.held > R.done
      A.pose >> B.pose
  `),
);

/** Every letter six wide: what a text needs is counted easily. */
const measure = (text: string) => text.length * 6;

function input(machine: Machine, camera: Camera, more: Partial<SceneInput> = {}): SceneInput {
  const overlay = more.overlay ?? NO_OVERLAY;
  const layout = layoutTreeOf(machine, { modes: MODES, contents: new Map() }, overlay.provisional);
  const view = { width: 800, height: 600 };
  return { ...PLAIN, layout, camera, view, modes: MODES, overlay, measure, ...more };
}

function seen(scale: number, more: Partial<SceneInput> = {}, at = { x: 0, y: 0 }): string[] {
  return listText(scene(input(PICK, { ...at, scale }, more))).split("\n");
}

const about = (lines: readonly string[], words: string) =>
  lines.filter((line) => line.includes(words));

describe("how much shows depends on the size on the screen", () => {
  test("a machine of a few pixels is a box", () => {
    expect(seen(0.03)).toEqual(["0 box state:R 0 0 12 9 shade0 |outline|"]);
  });

  test("a small one has its name and a texture of what is inside", () => {
    expect(seen(0.15)).toEqual([
      "0 box state:R 0 0 60 45 shade0 |outline|",
      '0 text state:R name "Pick a" 30 16 11px text',
      '0 text state:R name "part" 30 29 11px text',
      "1 speck state:R/A 6 9 15 12 shade1",
      "1 speck state:R/B 33 9 21 18 shade1",
    ]);
  });

  test("a selected state in a texture is an outline, upon which the name can be read", () => {
    const selection = new Set(["state:R/B"] as const);
    expect(about(seen(0.15, { selection }), "state:R/B")).toEqual([
      "1 speck state:R/B 33 9 21 18 selection 25%",
      "1 box state:R/B 33 9 21 18 |selection|",
    ]);
  });

  test("a larger one shows its children as boxes, and transitions with heads", () => {
    const lines = seen(0.4);
    expect(about(lines, "box state:R/A")).toEqual(["1 box state:R/A 16 24 40 32 shade1 |outline|"]);
    expect(about(lines, "line transition:R:1")).toHaveLength(1);
    expect(about(lines, "arrow")).not.toHaveLength(0);
    expect(about(lines, "name")).toEqual([
      '0 text state:R name "Pick a part" 10 15 12.5px text',
      '1 text state:R/A name "Look" 36 33 11px text',
      '1 text state:R/A name "for…" 36 47 11px text',
      '1 text state:R/B name "Grasp it" 116 48 11px text',
      '3 text outcome:R:0 name "done" 151 12 11px soft',
    ]);
  });

  test("a large one shows names of ports, and labels of transitions", () => {
    const lines = seen(2.5);
    expect(about(lines, "outcome:R/B:0 name")).toEqual([
      expect.stringContaining('"held" 890 168 11px soft'),
    ]);
    expect(about(lines, "label").map((line) => line.split(" ")[2])).toEqual([
      "transition:R:1",
      "transition:R:2",
      "transition:R/B:1",
    ]);
    expect(about(lines, "dot input:R/B:0")).toHaveLength(1);
  });
});

describe("names of ports", () => {
  const machine = machineOf(
    sketch(`
      R hierarchy 0 0 600 400 outcome done
        A "Look" execution 40 60 104 104 outcome seen output pose:list
        B "Take" execution 240 60 104 104 input the_pose_of_the_part:list
        C "Put" execution 440 60 104 104 outcome placed
        A.seen > B
    `),
  );
  const names = (modes: Partial<SceneInput["modes"]> = {}, scale = 1) => {
    const camera = { x: 0, y: 0, scale };
    const lines = listText(scene(input(machine, camera, { modes: { ...MODES, ...modes } })));
    return about(lines.split("\n"), " name ").flatMap(
      (line) => /text (?!state)\S+:R\/(\S+) name ("[^"]*")/.exec(line)?.slice(1).join(" ") ?? [],
    );
  };

  test("show beside small states where all of a name fits and no transition has it", () => {
    expect(names()).toEqual(['A:0 "pose"', 'C:0 "placed"']);
    expect(names({}, 0.65)).toEqual([]);
  });

  test("are hidden with those on transitions, and names of states stay", () => {
    for (const scale of [1, 3]) expect(names({ portNames: false }, scale)).toEqual([]);
    const list = scene(
      input(machine, { x: 0, y: 0, scale: 1 }, { modes: { ...MODES, portNames: false } }),
    );
    expect(about(listText(list).split("\n"), "label")).toEqual([]);
    expect(about(listText(list).split("\n"), 'state:R/A name "Look"')).toHaveLength(1);
  });
});

test("lines that run into each other have one label there", () => {
  const machine = machineOf(
    sketch(`
      R hierarchy 0 0 900 400 outcome done
        A execution 40 60 90 80 outcome success
        B execution 180 160 90 80 outcome success
        O execution 320 130 60 250
        C execution 760 60 90 80 outcome ok
        A.success > C
        B.success > C
    `),
  );
  const lines = listText(scene(input(machine, { x: 0, y: 0, scale: 1 }))).split("\n");
  expect(about(lines, " label ").map((line) => line.split(" ")[2])).toEqual(["transition:R:0"]);
});

test("the name of a container's outcome makes way for the line that ends there", () => {
  const place = (more: Partial<SceneInput> = {}) =>
    about(seen(2.5, more), "outcome:R/B:0").map((line) => line.split(" ").slice(3, 8).join(" "));
  const hidden = { modes: { ...MODES, transitions: false } };
  expect(place()).toEqual(["outcome 900 180 outcome", 'name "held" 890 168 11px']);
  expect(place(hidden)).toEqual(["outcome 900 180 outcome", 'name "held" 890 180 11px']);
});

describe("what is where", () => {
  test("nothing out of sight is drawn", () => {
    const lines = seen(4, {}, { x: 0, y: 0 });
    expect(about(lines, "state:R/A")).not.toHaveLength(0);
    expect(about(lines, "state:R/B")).toHaveLength(0);
  });

  test("a container around the view is a frame at its edges, with its ports in reach", () => {
    const lines = seen(40, {}, { x: 225, y: 70 });
    expect(about(lines, "sticky")).toEqual(
      expect.arrayContaining([
        expect.stringContaining("dot outcome:R/B:0 sticky outcome"),
        expect.stringContaining('"held"'),
        expect.stringContaining('"pose"'),
      ]),
    );
    expect(about(lines, "box frame")).toHaveLength(1);
    expect(about(lines, "outcome:R:0")).toHaveLength(0);
  });
});

test("a state without content around the view has its name and its ports in sight", () => {
  const lines = seen(60, {}, { x: 60, y: 80 });
  expect(about(lines, 'state:R/A name "Look for the part"')).toHaveLength(1);
  expect(about(lines, "dot outcome:R/A:0 sticky")).toHaveLength(1);
});

describe("what is picked out", () => {
  test("data flows show with the state that they belong to", () => {
    expect(about(seen(1.5), "data_flow")).toHaveLength(0);
    const selection = new Set(["state:R/A"]);
    expect(about(seen(1.5, { selection }), "data_flow:R:0")).toHaveLength(1);
    const all = { modes: { ...MODES, dataFlows: "all" } } as const;
    expect(about(seen(1.5, all), "under data_flow:R:0")).toHaveLength(1);
  });

  test("an outcome under the pointer lights where it leads", () => {
    const hovered = { kind: "outcome", path: "R/B/C", id: 0 } as const;
    const highlighted = about(seen(2, { hovered }), " highlight");
    expect(highlighted.map((line) => line.split(" ")[2])).toEqual([
      "transition:R:3",
      "transition:R/B:1",
    ]);
  });

  test("aborted and preempted hide while nothing leaves them, and show when asked for", () => {
    expect(about(seen(2), "dot outcome:R/A:-1")).toHaveLength(1);
    expect(about(seen(2), "dot outcome:R/A:-2")).toHaveLength(0);
    const modes = { ...MODES, aborted: true };
    expect(about(seen(2, { modes }), "dot outcome:R/A:-2")).toHaveLength(1);
  });

  test("selection, differences, finds and others are told apart", () => {
    const lines = seen(1, {
      selection: new Set(["state:R/A"]),
      differences: new Map([["state:R/B", "changed"]]),
      hits: new Set(["state:R/A"]),
      people: [{ name: "Anna", colour: 1, selection: ["R/B"] }],
      problems: new Map([["R/A", "error"]]),
    });
    expect(about(lines, "box state:R/A selection")).toHaveLength(1);
    expect(about(lines, "dot state:R/A handle")).toHaveLength(4);
    expect(about(lines, "|changed|")).toHaveLength(1);
    expect(about(lines, "|hit|")).toHaveLength(1);
    expect(about(lines, "|person1|")).toHaveLength(1);
    expect(about(lines, '"Anna"')).toHaveLength(1);
    expect(about(lines, "icon state:R/A error")).toHaveLength(1);
  });
});

test("breakpoints show on the border, hollow where they are off; the pointer shows where one would be", () => {
  const breakpoints = new Map([
    ["R/A", "on"],
    ["R/B", "off"],
  ] as const);
  const lines = seen(1, { breakpoints });
  expect(about(lines, "dot state:R/A breakpoint on")).toHaveLength(1);
  expect(about(lines, "dot state:R/B breakpoint off")).toHaveLength(1);
  expect(about(lines, "breakpoint none")).toHaveLength(0);
  const hovered = { kind: "state", path: "R/A" } as const;
  expect(about(seen(1, { hovered }), "dot state:R/A breakpoint none")).toHaveLength(1);
});

test("what a gesture holds is drawn where it is held, with what it says", () => {
  const position: [number, number] = [60, 160];
  const edit = { edit: "set_position", path: "R/A", element: "state", position } as const;
  const overlay = {
    ...NO_OVERLAY,
    provisional: { edit, held: new Set(["R/A"]), isScaled: false },
    guides: [{ from: { x: 60, y: 0 }, to: { x: 60, y: 300 } }],
    message: { at: { x: 10, y: 10 }, text: "not here", bad: true },
  };
  const lines = seen(1, { overlay });
  expect(about(lines, "box state:R/A")).toEqual([
    "17 box state:R/A 60 160 100 80 shade1 |outline|",
  ]);
  expect(about(lines, "guide")).toEqual([expect.stringContaining("60 0 60 300 guide dashed")]);
  expect(about(lines, "not here")).toHaveLength(1);
});

test("lines that take too long to find are left for the next frame", () => {
  const fresh = machineOf({
    header: PICK.header,
    states: [...PICK.paths()].flatMap((path) => PICK.state(path) ?? []),
  });
  const list = scene(input(fresh, { x: 0, y: 0, scale: 1 }, { mayRoute: () => false }));
  expect(list.unfinished).toBe(true);
  expect(listText(list)).not.toContain("transition");
});

test("a library whose content is not here yet is asked for", () => {
  const machine = machineOf(
    sketch(`
      R hierarchy 0 0 400 300
        L "Grasp" library 40 60 200 150 library=hands/grasp
    `),
  );
  const plain = input(machine, { x: 0, y: 0, scale: 1 });
  const view = { modes: MODES, contents: new Map([["R/L", true]]) };
  const list = scene({ ...plain, layout: layoutTreeOf(machine, view) });
  expect(list.wanted).toEqual(["R/L"]);
});
