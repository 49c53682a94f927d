import { expect, test } from "vitest";
import type { Edit } from "../model/generated/protocol.ts";
import { intersects } from "../model/geometry.ts";
import { changed } from "../model/layout.ts";
import { readLayout } from "../model/layout_reader.ts";
import { machineOf } from "../model/plain_machine.ts";
import { boxIn } from "./boxes.ts";
import { clipOf, copySelection, duplicate, paste, pasteClip } from "./clipboard.ts";
import { group, substitute } from "./group.ts";
import {
  align,
  distribute,
  lostConnections,
  move,
  moveInto,
  movePort,
  resize,
  setBackground,
  setSide,
} from "./move.ts";
import { isRefused } from "./plan.ts";
import { drawn, editsOf, lines, made, reason } from "./testing/plans.ts";
import { ungroup } from "./ungroup.ts";

const machine = drawn(`
  R "Root" hierarchy 0 0 400 300 outcome done
    A "Scan" execution 20 20 80 60 outcome ok
    B "Grasp" execution 200 40 80 60 outcome ok
    C "Inner" hierarchy 20 120 160 120 outcome out
      D "Deep" execution 10 10 40 40 outcome ok
    R > A
    A.ok > B
    B.ok > R.done
`);

const bare = drawn(`
  R hierarchy 0 0 100 100 outcome done
    A execution outcome ok
    B execution outcome ok
`);

test("states move together and stay in their container", () => {
  expect(lines(move(machine, ["R/A"], { x: 10, y: 5 }))).toEqual([
    "set_position R/A element=state position=[30,25]",
  ]);
  expect(lines(move(machine, ["R/A", "R/B"], { x: -500, y: 0 }))).toEqual([
    "set_position R/A element=state position=[12,20]",
    "set_position R/B element=state position=[192,40]",
  ]);
  expect(reason(move(machine, ["R"], { x: 1, y: 1 }))).toContain("root");
  expect(reason(move(machine, ["R/A", "R/C/D"], { x: 1, y: 1 }))).toContain("different containers");
});

test("a state on the border is moved along it, and keeps room for lines once it has some", () => {
  const onBorder = drawn(`
    R hierarchy 0 0 400 300 outcome done
      A execution 0 20 80 60 outcome ok
  `);
  const put = (x: number, y: number) => lines(move(onBorder, ["R/A"], { x, y }));
  expect(put(0, 10)).toEqual(["set_position R/A element=state position=[0,30]"]);
  expect(put(0, -20)).toEqual(["set_position R/A element=state position=[0,12]"]);
  expect(put(900, 900)).toEqual(["set_position R/A element=state position=[308,228]"]);
});

test("a state that fills its container nearly is moved to its middle", () => {
  const full = drawn(`
    R hierarchy 0 0 400 300 outcome done
      A execution 0 0 390 60 outcome ok
  `);
  expect(lines(move(full, ["R/A"], { x: 90, y: 0 }))).toEqual([
    "set_position R/A element=state position=[5,0]",
  ]);
});

test("a coordinate that is typed moves a state within its container and keeps its size", () => {
  const put = (side: "x" | "width", value: number) =>
    lines(setSide(machine, "R/A", { side, value }, false));
  expect(put("x", 100)).toEqual(["set_position R/A element=state position=[100,20]"]);
  expect(put("x", -50)).toEqual(["set_position R/A element=state position=[12,20]"]);
  expect(put("x", 5_000)).toEqual(["set_position R/A element=state position=[308,20]"]);
  expect(put("width", 90).join()).not.toContain("set_position R/A element=state position=[12");
});

test("states that come into a container, or are copied there, have room for lines at its border", () => {
  const into = lines(moveInto(machine, ["R/A"], "R/C", { x: -5, y: 90 }));
  expect(into[0]).toBe("set_position R/A element=state position=[4.8,55.2]");
  const copy = editsOf(duplicate(machine, ["R/A"], { x: -90, y: -90 })).find(
    ({ edit }) => edit === "paste",
  );
  const [copied] = copy?.edit === "paste" ? (copy.selection.states ?? []) : [];
  expect(copied && readLayout(copied).position).toEqual({ x: 12, y: 12 });
});

test("what has no place in the file gets the one where it shows", () => {
  const edits = lines(move(bare, ["R/B"], { x: 5, y: 0 }));
  expect(edits).toEqual([
    "set_position R/B element=state position=[33,12]",
    "set_size R/B element=state size=[20,20]",
  ]);
});

test("a state goes into another container with a place and an id of its own there", () => {
  expect(lines(moveInto(machine, ["R/A"], "R/C", { x: 60, y: 50 }))).toEqual([
    "set_position R/A element=state position=[60,50]",
    'move_states R states=["A"] to=R/C ids=["A"]',
  ]);
  expect(reason(moveInto(machine, ["R/C"], "R/C", { x: 0, y: 0 }))).toContain("itself");
  expect(reason(moveInto(machine, ["R/A"], "R/B", { x: 0, y: 0 }))).toContain(
    "cannot contain states",
  );
});

test("what is too large for a container is made smaller", () => {
  const small = drawn(`
    R hierarchy 0 0 400 300 outcome done
      A execution 0 0 200 100 outcome ok
      C hierarchy 210 0 100 100 outcome ok
  `);
  const [first] = editsOf(moveInto(small, ["R/A"], "R/C", { x: 0, y: 0 }));
  expect(
    first?.edit === "set_layout" &&
      first.layout &&
      readLayout({ ...state, layout: first.layout }).size,
  ).toEqual({
    width: 80,
    height: 40,
  });
});

const state = { path: "A", name: "A", kind: "execution" } as const;

function boxes(edits: readonly Edit[]): Record<string, unknown> {
  return Object.fromEntries(
    edits.flatMap((edit) => {
      if (edit.edit !== "set_layout" || !edit.layout) return [];
      const { position, size } = readLayout({ ...state, layout: edit.layout });
      return [[edit.path, [position?.x, position?.y, size?.width, size?.height]]];
    }),
  );
}

test("with its content a state is resized in proportion", () => {
  const plan = resize(machine, "R/C", { x: 20, y: 120, width: 80, height: 60 }, true);
  expect(boxes(editsOf(plan))).toEqual({ "R/C": [20, 120, 80, 60], "R/C/D": [5, 5, 20, 20] });
});

test("without its content everything inside stays where it shows", () => {
  const plan = resize(machine, "R/C", { x: 10, y: 110, width: 170, height: 130 }, false);
  expect(lines(plan).slice(1)).toEqual(["set_position R/C/D element=state position=[20,20]"]);
  const small = editsOf(resize(machine, "R/C", { x: 20, y: 120, width: 1, height: 1 }, false));
  expect(boxes(small)["R/C"]).toEqual([20, 120, 40, 40]);
});

test("states line up and get even gaps", () => {
  expect(lines(align(machine, ["R/A", "R/B", "R/C"], "left"))).toEqual([
    "set_position R/B element=state position=[20,40]",
  ]);
  expect(lines(distribute(machine, ["R/A", "R/B", "R/C"], "vertical"))).toHaveLength(1);
  expect(reason(distribute(machine, ["R/A", "R/B"], "vertical"))).toContain("three");
});

test("a port goes to the nearest point of the border", () => {
  expect(
    lines(movePort(machine, { kind: "outcome", path: "R/A", id: 0 }, { x: 70, y: 30 })),
  ).toEqual(['set_position R/A element={"outcome":0} position=[80,30]']);
});

test("a colour is written as the reference writes it", () => {
  const [edit] = editsOf(setBackground(machine, "R/A", [255, 0, 51]));
  expect(
    edit?.edit === "set_layout" && readLayout({ ...state, layout: edit.layout }).background,
  ).toBe("rgb(255 0 51)");
});

test("a group has room for its name and keeps what stands in it in place", () => {
  const edits = editsOf(group(machine, ["R/A", "R/B"]));
  const set = edits.find(({ edit }) => edit === "set_layout");
  const layout = set?.edit === "set_layout" ? readLayout({ ...state, layout: set.layout }) : null;
  expect([layout?.position, layout?.size]).toEqual([
    { x: 1.8, y: 0 },
    { width: 296.4, height: 118.2 },
  ]);
  const two = drawn(`
    R hierarchy outcome done
      S execution outcome one outcome two
      A execution outcome ok
      B execution outcome ok
      S.one > A
      S.two > B
  `);
  expect(reason(group(two, ["R/A", "R/B"]))).toContain("both A and B");
  expect(reason(group(machine, ["R"]))).toContain("root");
});

test("children of an ungrouped state stand where they showed", () => {
  expect(lines(ungroup(machine, "R/C"))).toEqual([
    "set_position R/C/D element=state position=[30,130]",
    "ungroup R state=C fresh=[]",
  ]);
  expect(reason(ungroup(machine, "R/A"))).toContain("cannot contain states");
});

test("what only fitted by way of an object port keeps a state together", () => {
  const passing = drawn(`
    R hierarchy outcome done
      A execution outcome ok output text:str
      C hierarchy outcome ok input any:object
        D execution outcome ok input many:list
        C.any >> D.many
      A.text >> C.any
  `);
  expect(reason(ungroup(passing, "R/C"))).toBe(
    "The value of A.text (str) would flow directly to D.many (list), which does not fit: change one of the types, or use object.",
  );
});

test("a substitute has the box of the state that goes", () => {
  const other = { path: "NEW", name: "New", kind: "execution", outcomes: [] } as const;
  const [edit] = editsOf(substitute(machine, "R/B", [{ ...other, outcomes: [] }], true));
  const [root] = edit?.edit === "substitute_state" ? edit.states : [];
  expect([root?.path, root?.name]).toEqual(["B", "Grasp"]);
  expect(root && readLayout(root).position).toEqual({ x: 200, y: 40 });
});

test("copies come with what is between them, and beside what is there", () => {
  const selection = copySelection(machine, [
    { kind: "state", path: "R/A" },
    { kind: "state", path: "R/B" },
  ]);
  if (isRefused(selection)) throw new Error(selection.refused);
  expect(selection.transitions).toHaveLength(1);
  const plan = made(paste(machine, "R", selection));
  expect(plan.select?.map(({ path }) => path).filter((path) => path === "R/A")).toEqual([]);
  const inner = editsOf(paste(machine, "R/C", selection, { x: 80, y: 60 }));
  expect(inner.at(-1)).toMatchObject({ edit: "paste", path: "R/C", ids: ["A", "B"] });
  expect(made(duplicate(machine, ["R/A"], { x: 5, y: 5 })).name).toBe("Duplicate Scan");
  expect(reason(paste(machine, "R/A", selection))).toContain("cannot contain states");
});

test("copies keep the waypoints of what connects them, where they come to stand", () => {
  const bent = drawn(`
    R hierarchy 0 0 400 300 outcome ok
      A execution 20 20 80 60 outcome ok
      B execution 200 20 80 60 outcome ok
      C hierarchy 20 120 200 150 outcome ok
      R > A
      A.ok > B
      B.ok > R.ok
  `);
  const root = bent.state("R");
  if (!root) throw new Error("no root");
  const states = [...bent.paths()].flatMap((path) => bent.state(path) ?? []);
  const way = new Map([["transition1", [{ x: 150, y: 90 }]]]);
  const own = { ...root, layout: changed(root.layout, { waypoints: way }) };
  const curved = machineOf({
    header: bent.header,
    states: states.map((state) => (state === root ? own : state)),
  });
  const both = [
    { kind: "state", path: "R/A" },
    { kind: "state", path: "R/B" },
  ] as const;
  const twins = editsOf(
    duplicate(
      curved,
      both.map(({ path }) => path),
      { x: 10, y: 30 },
    ),
  );
  expect(twins.at(-1)).toEqual({
    edit: "set_waypoints",
    path: "R",
    element: { transition: 3 },
    waypoints: [[160, 120]],
  });
  const clip = clipOf(curved, both);
  if (isRefused(clip)) throw new Error(clip.refused);
  const goal = { container: { path: "R/C", at: { x: 100, y: 75 } }, owner: null };
  const inner = editsOf(pasteClip(curved, clip, goal));
  expect(inner.at(-1)).toMatchObject({
    edit: "set_waypoints",
    path: "R/C",
    element: { transition: 1 },
    waypoints: [[100, expect.closeTo(99.6, 1)]],
  });
});

test("copies keep the places of ports and names inside them, in proportion", () => {
  const [root, child] = [machine.state("R"), machine.state("R/A")];
  if (!root || !child) throw new Error("no states");
  const layout = changed(child.layout, {
    ports: new Map([["outcome0", { x: 80, y: 30 }]]),
    nameBox: { x: 10, y: 10, width: 40, height: 20 },
  });
  const states = [...machine.paths()].flatMap((path) => machine.state(path) ?? []);
  const placed = machineOf({
    header: machine.header,
    states: states.map((state) => (state === child ? { ...child, layout } : state)),
  });
  const clip = clipOf(placed, [{ kind: "state", path: "R/A" }]);
  if (isRefused(clip)) throw new Error(clip.refused);
  const goal = { container: { path: "R/C", at: { x: 50, y: 40 } }, owner: null };
  const edit = editsOf(pasteClip(placed, clip, goal)).find((each) => each.edit === "paste");
  const copy = edit?.edit === "paste" ? edit.selection.states?.[0] : undefined;
  if (!copy) throw new Error("nothing is pasted");
  const { size, ports, nameBox } = readLayout(copy);
  const factor = (size?.width ?? 0) / boxIn(placed, "R/A").width;
  expect(ports.get("outcome0")?.y).toBeCloseTo(30 * factor);
  expect(nameBox?.width).toBeCloseTo(40 * factor);
});

const bent = drawn(`
  R "Root" hierarchy 0 0 1000 600 outcome done
    A "Scan" execution 100 100 100 100 outcome ok
    B "Grasp" execution 600 300 100 100 outcome ok
    A.ok > B
`);

/** The bends of the line from A to B after A was moved; its outcome stands at 200, 110, B's income at 600, 310. */
function bendsAfter(by: { x: number; y: number }, bends: readonly [number, number][]): string {
  const root = bent.state("R");
  const id = root?.transitions?.[0]?.id ?? 0;
  const waypoints = new Map([[`transition${id}`, bends.map(([x, y]) => ({ x, y }))]]);
  const layout = changed(root?.layout, { waypoints });
  const states = [...bent.paths()].flatMap((path) => bent.state(path) ?? []);
  const machine = machineOf({
    header: bent.header,
    states: states.map((state) => (state.path === "R" ? { ...state, layout } : state)),
  });
  const edits = lines(move(machine, ["R/A"], by)).filter((line) => line.includes("waypoints"));
  return edits.join("; ").replace(/set_waypoints R element=\S+ /, "") || "as before";
}

test("a line whose end moves keeps its right angles, and bends that would lead back go", () => {
  const orthogonal: readonly [number, number][] = [
    [400, 110],
    [400, 310],
  ];
  expect(bendsAfter({ x: 20, y: 50 }, orthogonal)).toBe("waypoints=[[400,160],[400,310]]");
  expect(bendsAfter({ x: 300, y: 0 }, orthogonal)).toBe("waypoints=[]");
  expect(bendsAfter({ x: 20, y: 50 }, [[400, 50]])).toBe("as before");
});

const waiting = drawn(`
  R "Root" hierarchy 0 0 400 300 outcome done
    A "Scan" execution 20 20 80 60 outcome ok
    B "Grasp" execution 200 40 80 60 outcome ok
    C "Empty" hierarchy 20 120 160 120 outcome out
    R > A
    A.ok > B
    B.ok > R.done
`);

test("what comes first into an empty hierarchy is its start", () => {
  expect(lines(moveInto(waiting, ["R/A", "R/B"], "R/C", { x: 0, y: 0 })).at(-1)).toBe(
    'set_start R/C to={"state":"A"}',
  );
  expect(lines(moveInto(waiting, ["R/B"], "R/C", { x: 0, y: 0 })).at(-1)).toBe(
    'set_start R/C to={"state":"B"}',
  );
});

test("how many connections a state loses in another container is known", () => {
  expect(lostConnections(waiting, ["R/A"])).toBe(2);
  expect(lostConnections(waiting, ["R/A", "R/B"])).toBe(2);
  expect(lostConnections(waiting, ["R/C"])).toBe(0);
});

const crowded = drawn(`
  R "Root" hierarchy 0 0 400 300 outcome done
    A execution 20 60 80 60 outcome ok
    B execution 120 60 80 60 outcome ok
    C execution 220 60 80 60 outcome ok
    D execution 20 160 80 60 outcome ok
`);

/** Whether the new group overlaps a state that is not in it. */
function overlaps(paths: readonly string[]): readonly string[] {
  const edits = editsOf(group(crowded, paths));
  const layout = edits.find((edit) => edit.edit === "set_layout")?.layout;
  const box = layout && readLayout({ path: "G", kind: "hierarchy", layout } as never);
  if (!box?.position || !box.size) throw new Error("the group has no box");
  const own = { ...box.position, ...box.size };
  return crowded
    .children("R")
    .filter((path) => !paths.includes(path) && intersects(own, boxIn(crowded, path)));
}

test("a group keeps clear of its neighbours", () => {
  expect(overlaps(["R/A", "R/B"])).toEqual([]);
  expect(overlaps(["R/D"])).toEqual([]);
  expect(overlaps(["R/A", "R/C"])).toEqual([]);
});
