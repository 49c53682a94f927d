import { describe, expect, test } from "vitest";
import type { Document, Edit, StateDocument } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { MODES } from "../../store/page/view.ts";
import type { ProvisionalEdit } from "../overlay.ts";
import { type LayoutTree, layoutTreeOf } from "./layout_tree.ts";

const NO_CONTENTS: ReadonlyMap<string, boolean> = new Map();

/** A machine in which single states can be exchanged. */
function changing(text: string) {
  let plain = machineOf(sketch(text));
  let document: Document = sketch(text);
  let version = 0;
  const machine: Machine = {
    get version() {
      return version;
    },
    root: plain.root,
    header: plain.header,
    state: (path) => plain.state(path),
    children: (path) => plain.children(path),
    isInLibrary: () => false,
    paths: () => plain.paths(),
  };
  document = { ...document, states: [...plain.paths()].flatMap((path) => plain.state(path) ?? []) };
  const change = (path: string, by: (state: StateDocument) => StateDocument | null) => {
    const states = document.states.flatMap((state) =>
      state.path === path ? (by(state) ?? []) : [state],
    );
    document = { ...document, states };
    plain = machineOf(document);
    version++;
  };
  const layout = (edit: ProvisionalEdit | null = null): LayoutTree =>
    layoutTreeOf(machine, { modes: MODES, contents: NO_CONTENTS }, edit);
  return { machine, change, layout };
}

const at = (x: number, y: number, width: number, height: number) => ({
  gui: { editor_gaphas: { rel_pos: [x, y], size: [width, height] } },
});

const STATE = { path: "R/A", element: "state" } as const;

function shown(edit: Edit): ProvisionalEdit {
  return { edit, held: new Set(["R/A"]), isScaled: false };
}

const TWO = `
  R hierarchy 0 0 400 300 outcome done
    A hierarchy 20 40 160 120 outcome ok
      C execution 30 40 60 40 outcome ok
      C.ok > A.ok
    B execution 240 40 80 60 outcome ok
    A.ok > B
    B.ok > R.done
`;

describe("places", () => {
  test("are in the root's coordinates, however deep", () => {
    const layout = changing(TWO).layout();
    expect(layout.box("R/A/C")).toEqual({ x: 50, y: 80, width: 60, height: 40 });
    expect(layout.box("R/X")).toBeUndefined();
    expect(layout.children("R")).toEqual(["R/A", "R/B"]);
    const ok = layout.ports("R/A/C").find(({ name }) => name === "ok");
    expect(ok?.at).toEqual({ x: 110, y: 84 });
    expect(layout.routes("R").map(({ id }) => id)).toEqual([0, 1]);
  });

  test("stay the same objects until something is different", () => {
    const { layout } = changing(TWO);
    expect(layout()).toBe(layout());
  });

  test("of what did not change are kept when something else does", () => {
    const { layout, change } = changing(TWO);
    const before = layout();
    before.routes("R/A");
    const [a, b] = before.root?.children ?? [];
    change("R/B", (state) => ({ ...state, layout: at(240, 140, 80, 60) }));
    const after = layout();
    expect(after.root?.children[0]).toBe(a);
    expect(after.root?.children[1]).not.toBe(b);
    expect(after.box("R/B")).toEqual({ x: 240, y: 140, width: 80, height: 60 });
  });

  test("follow states that move, come and go", () => {
    const { layout, change } = changing(TWO);
    layout().box("R/A/C");
    change("R/A", (state) => ({ ...state, layout: at(60, 80, 160, 120) }));
    expect(layout().box("R/A/C")).toEqual({ x: 90, y: 120, width: 60, height: 40 });
    change("R/B", () => null);
    expect(layout().box("R/B")).toBeUndefined();
    expect(layout().routes("R")).toEqual([]);
  });
});

describe("what a gesture holds", () => {
  test("is where it is held, with all inside it and the lines to it", () => {
    const { layout } = changing(TWO);
    const rest = layout().routes("R");
    const held = layout(shown({ ...STATE, edit: "set_position", position: [20, 140] }));
    expect(held.box("R/A/C")).toEqual({ x: 50, y: 180, width: 60, height: 40 });
    expect(held.routes("R")[0]).not.toEqual(rest[0]);
    expect(held.routes("R")[1]).toEqual(rest[1]);
    expect(held.root?.children[0]?.children).toEqual(layout().root?.children[0]?.children);
  });

  test("a box that grows keeps its content, or takes it along", () => {
    const { layout } = changing(TWO);
    const grown = shown({ ...STATE, edit: "set_size", size: [320, 240] });
    expect(layout(grown).box("R/A/C")?.width).toBe(60);
    const scaled = layout({ ...grown, isScaled: true });
    expect(scaled.box("R/A/C")).toEqual({ x: 80, y: 120, width: 120, height: 80 });
    const ok = scaled.ports("R/A/C").find(({ name }) => name === "ok");
    expect(ok?.at).toEqual({ x: 200, y: 128 });
  });

  test("ports and waypoints lead their lines along", () => {
    const { layout } = changing(TWO);
    const element = { transition: 1 };
    const edits: Edit[] = [
      { edit: "set_position", path: "R/B", element: "income", position: [0, 50] },
      { edit: "set_waypoints", path: "R", element, waypoints: [[350, 200]] },
    ];
    const held = layout(shown({ edit: "batch", edits }));
    expect(held.routes("R")[0]?.points.at(-1)).toEqual({ x: 240, y: 90 });
    expect(held.routes("R")[1]?.points).toContainEqual({ x: 350, y: 200 });
  });
});

test("content of a library is as large as fits into it, at any depth", () => {
  const document = sketch(`
    R hierarchy 0 0 400 300
      L library 40 60 220 110 library=hands/grasp
      H hierarchy 40 200 100 50
        M library 10 10 40 20 library=hands/grasp
  `);
  const content = sketch(`
    G hierarchy 0 0 1000 500
      S execution 100 100 200 100
  `);
  const outer = machineOf(document);
  const inner = machineOf(content);
  const within = (path: string) => /^R\/(L|H\/M)\/(.*)/.exec(path)?.[2];
  const machine: Machine = {
    ...outer,
    state: (path) => {
      const found = within(path);
      return found === undefined ? outer.state(path) : inner.state(found);
    },
    children: (path) => {
      const found = within(path);
      if (outer.state(path)?.kind === "library") return [`${path}/G`];
      if (found === undefined) return outer.children(path);
      return inner.children(found).map((child) => path.slice(0, -found.length) + child);
    },
    isInLibrary: (path) => within(path) !== undefined,
  };
  const hidden = layoutTreeOf(machine, { modes: MODES, contents: NO_CONTENTS });
  expect(hidden.box("R/L")?.width).toBe(220);
  const early = new Map([["R/L", true]]);
  const opened = layoutTreeOf(machine, { modes: MODES, contents: early });
  expect(opened.children("R/L")).toEqual(["R/L/G"]);
  expect(layoutTreeOf(machine, { modes: MODES, contents: NO_CONTENTS }).box("R/L/G")).toBe(
    undefined,
  );
  expect(hidden.children("R/L")).toEqual([]);
  const contents = new Map([
    ["R/L", true],
    ["R/H/M", true],
  ]);
  const shown = layoutTreeOf(machine, { modes: MODES, contents });
  expect(shown.children("R/H/M")).toEqual(["R/H/M/G"]);
  const unit = shown.unit("R/L/G");
  expect(unit).toBeCloseTo(0.2024);
  expect(shown.box("R/L/G/S")?.width).toBeCloseTo(200 * unit);
  expect(shown.ports("R/L/G/S")[0]?.at.x).toBeCloseTo(shown.box("R/L/G/S")?.x ?? Number.NaN);
});
