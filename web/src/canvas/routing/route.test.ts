import fc from "fast-check";
import { describe, expect, test } from "vitest";
import type { Box, Point } from "../../model/geometry.ts";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { MODES } from "../../store/page/view.ts";
import { touches } from "../layout/grid.ts";
import { layoutTreeOf } from "../layout/layout_tree.ts";
import type { RoutedLine } from "../layout/lines.ts";

function linesOf(text: string): readonly RoutedLine[] {
  const machine = machineOf(sketch(text));
  const layout = layoutTreeOf(machine, { modes: MODES, contents: new Map() });
  return layout.root?.lines ?? [];
}

const corners = ({ points }: RoutedLine) =>
  points.map(({ x, y }) => `${Math.round(x)},${Math.round(y)}`);

/** How far the lines run through boxes that are not theirs. */
function through(text: string): number {
  const machine = machineOf(sketch(text));
  const layout = layoutTreeOf(machine, { modes: MODES, contents: new Map() });
  let length = 0;
  for (const { points } of layout.root?.lines ?? []) {
    for (let index = 0; index + 1 < points.length; index++) {
      const [one, other] = [points[index], points[index + 1]];
      if (!one || !other) continue;
      for (const { box } of layout.root?.children ?? []) {
        const wide =
          Math.min(Math.max(one.x, other.x), box.x + box.width) -
          Math.max(Math.min(one.x, other.x), box.x);
        const high =
          Math.min(Math.max(one.y, other.y), box.y + box.height) -
          Math.max(Math.min(one.y, other.y), box.y);
        if (wide >= 0 && high >= 0) length += wide + high;
      }
    }
  }
  return length;
}

describe("transitions", () => {
  test("lead straight from port to port where they can", () => {
    const [line] = linesOf(`
      R hierarchy 0 0 400 200
        A execution 40 40 80 60 outcome ok
        B execution 200 40 80 60
        A.ok > B
    `);
    expect(line && corners(line)).toEqual(["120,46", "200,46"]);
  });

  test("go around what stands between", () => {
    const text = `
      R hierarchy 0 0 600 300
        A execution 40 100 80 60 outcome ok
        B execution 200 90 80 80
        C execution 360 100 80 60
        A.ok > C
    `;
    expect(through(text)).toBe(0);
    const [line] = linesOf(text);
    expect(line?.points.length).toBeGreaterThan(3);
  });

  test("lead back around both states, and from a state to itself", () => {
    const text = `
      R hierarchy 0 0 400 200
        A execution 60 60 80 60 outcome ok
        B execution 220 60 80 60 outcome again outcome self
        A.ok > B
        B.again > A
        B.self > B
    `;
    expect(through(text)).toBe(0);
  });

  test("stay in their container, also to a state on its border", () => {
    const [line] = linesOf(`
      R hierarchy 0 0 400 200
        A execution 0 120 80 60 outcome ok
        R > A
    `);
    expect(Math.min(...(line?.points ?? []).map(({ x }) => x))).toBe(0);
  });

  test("to one target share their way, and others keep apart", () => {
    const lines = linesOf(`
      R hierarchy 0 0 900 300
        A execution 40 100 80 60 outcome ok
        B execution 200 100 80 60 outcome ok
        C execution 360 100 80 60 outcome ok
        E execution 700 200 80 60
        A.ok > B
        B.ok > C
        A.aborted > E
        B.aborted > E
        C.aborted > E
    `);
    const lying = lines.slice(2).map(({ points }) => {
      const at = points.findIndex((point, index) => {
        const next = points[index + 1];
        return next && point.y === next.y && Math.abs(point.x - next.x) > 100;
      });
      return Math.round(points[at]?.y ?? Number.NaN);
    });
    expect(new Set(lying).size).toBe(1);
    expect(
      through(`
      R hierarchy 0 0 900 300
        A execution 40 100 80 60 outcome ok
        B execution 200 100 80 60 outcome ok
        E execution 700 200 80 60
        A.aborted > E
        B.aborted > E
    `),
    ).toBe(0);
  });

  test("obey the author's waypoints", () => {
    const document = sketch(`
      R hierarchy 0 0 400 200
        A execution 40 40 80 60 outcome ok
        B execution 200 40 80 60
        A.ok > B
    `);
    const [root, ...states] = document.states;
    if (!root) throw new Error("no root");
    const layout = {
      ...root.layout,
      transition0: { gui: { editor_gaphas: { waypoints: [[150, 150]] } } },
    };
    const machine = machineOf({ ...document, states: [{ ...root, layout }, ...states] });
    const layoutTree = layoutTreeOf(machine, { modes: MODES, contents: new Map() });
    const [route] = layoutTree.routes("R");
    expect(route?.waypoints).toEqual([2]);
    expect(route?.points[2]).toEqual({ x: 150, y: 150 });
  });
});

/** Which part of a cell its state takes, and where in it. */
interface Cell {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

/** States in cells that leave gaps between them, and transitions between any of them. */
const MACHINES = fc.record({
  cells: fc.array(
    fc.record({
      x: fc.double({ min: 0.05, max: 0.4, noNaN: true }),
      y: fc.double({ min: 0.05, max: 0.4, noNaN: true }),
      width: fc.double({ min: 0.2, max: 0.5, noNaN: true }),
      height: fc.double({ min: 0.2, max: 0.5, noNaN: true }),
    }),
    { minLength: 2, maxLength: 16 },
  ),
  lines: fc.array(fc.record({ from: fc.nat(15), to: fc.nat(16) }), {
    minLength: 1,
    maxLength: 24,
  }),
});

function randomMachine(
  cells: readonly Cell[],
  lines: readonly { readonly from: number; readonly to: number }[],
) {
  const text = ["R hierarchy 0 0 400 400 outcome done"];
  cells.forEach(({ x, y, width, height }, index) => {
    const at = [100 * ((index % 4) + x), 100 * (Math.floor(index / 4) + y)];
    const outcomes = "outcome one outcome two";
    text.push(
      `  S${index} execution ${[...at, 100 * width, 100 * height].map((n) => n.toFixed(3)).join(" ")} ${outcomes}`,
    );
  });
  text.push("  R > S0");
  for (const { from, to } of lines) {
    const target = to % (cells.length + 1);
    const goal = target === cells.length ? "R.done" : `S${target}`;
    text.push(`  S${from % cells.length}.${from % 2 ? "one" : "two"} > ${goal}`);
  }
  return machineOf(sketch(text.join("\n")));
}

test("no line leads through a state, whatever stands between", () => {
  fc.assert(
    fc.property(MACHINES, ({ cells, lines }) => {
      const machine = randomMachine(cells, lines);
      const { root } = layoutTreeOf(machine, { modes: MODES, contents: new Map() });
      for (const { points, key } of root?.lines ?? []) {
        const crossed = root?.children.filter(({ box }) => isThrough(points, box));
        expect(
          crossed?.map(({ path }) => path),
          key,
        ).toEqual([]);
        expect(isRightAngled(points), key).toBe(true);
      }
    }),
  );
});

const LEAST = 1e-6;

function isThrough(points: readonly Point[], box: Box): boolean {
  const inner = {
    x: box.x + LEAST,
    y: box.y + LEAST,
    width: box.width - 2 * LEAST,
    height: box.height - 2 * LEAST,
  };
  return points.slice(1).some((to, index) => {
    const from = points[index] ?? to;
    const [x, y] = [Math.min(from.x, to.x), Math.min(from.y, to.y)];
    return touches(
      { x, y, width: Math.abs(from.x - to.x), height: Math.abs(from.y - to.y) },
      inner,
    );
  });
}

function isRightAngled(points: readonly Point[]): boolean {
  return points.every((to, index) => {
    const from = points[index - 1] ?? to;
    return Math.abs(from.x - to.x) < LEAST || Math.abs(from.y - to.y) < LEAST;
  });
}
