import fc from "fast-check";
import { expect, test } from "vitest";
import type { Edit } from "../../model/generated/protocol.ts";
import type { Box, Point } from "../../model/geometry.ts";
import { type Machine, transitionsOf } from "../../model/machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { boxIn } from "../../plan/boxes.ts";
import { group } from "../../plan/group.ts";
import { align, distribute, move, movePort, resize } from "../../plan/move.ts";
import { isRefused, type Planned, together } from "../../plan/plan.ts";
import { isStoredRightAngled, lineEnds, storedWay } from "../../plan/right_angles.ts";
import { ungroup } from "../../plan/ungroup.ts";
import { OptimisticDocument } from "../../store/document/optimistic_document.ts";
import { predictedWrites } from "../../store/document/predict/predict.ts";

interface Shape {
  readonly places: readonly Box[];
  readonly lines: readonly {
    readonly from: number;
    readonly to: number;
    readonly middle: number;
  }[];
}

const part = fc.double({ min: 0.05, max: 0.45, noNaN: true });

const SHAPES: fc.Arbitrary<Shape> = fc.record({
  places: fc.array(fc.record({ x: part, y: part, width: part, height: part }), {
    minLength: 3,
    maxLength: 9,
  }),
  lines: fc.array(
    fc.record({
      from: fc.nat(8),
      to: fc.nat(9),
      middle: fc.double({ min: 0, max: 1, noNaN: true }),
    }),
    { minLength: 1, maxLength: 12 },
  ),
});

/** A machine whose transitions all have a stored way: level, upright, level. */
function machineOfShape({ places, lines }: Shape): OptimisticDocument {
  const text = ["R hierarchy 0 0 300 300 outcome done", "  G hierarchy 0 0 300 300 outcome out"];
  places.forEach(({ x, y, width, height }, index) => {
    const at = [100 * ((index % 3) + x), 100 * (Math.floor(index / 3) + y)];
    const box = [...at, 100 * width, 100 * height].map((each) => each.toFixed(3));
    text.push(`    S${index} execution ${box.join(" ")} outcome ok`);
  });
  text.push("    G > S0");
  for (const { from, to } of lines) {
    const target = to % (places.length + 1);
    const goal = target === places.length ? "G.out" : `S${target}`;
    text.push(`    S${from % places.length}.ok > ${goal}`);
  }
  const machine = new OptimisticDocument(sketch(text.join("\n")), () => undefined);
  const state = machine.state("R/G");
  apply(
    machine,
    (state ? transitionsOf(state) : []).map((line, index): Edit => {
      const waypoints = zigzag(machine, line, lines[index - 1]?.middle ?? 0.5);
      return { edit: "set_waypoints", path: "R/G", element: { transition: line.id }, waypoints };
    }),
  );
  return machine;
}

function zigzag(machine: Machine, line: Parameters<typeof lineEnds>[2], middle: number) {
  const { start, goal } = lineEnds(machine, "R/G", line);
  if (!start || !goal) throw new Error(`a line without ends: ${line.id}`);
  const x = start.x + (goal.x - start.x) * middle;
  return [
    [x, start.y],
    [x, goal.y],
  ] as [number, number][];
}

function apply(machine: OptimisticDocument, edits: readonly Edit[]): void {
  const writes = predictedWrites(machine, together(edits));
  if (!writes) throw new Error("not predicted");
  machine.transact(() => machine.applyOptimistic(writes));
}

function slanted(machine: Machine): readonly number[] {
  const state = machine.state("R/G");
  return (state ? transitionsOf(state) : []).flatMap((line) => {
    const isStored = storedWay(machine, "R/G", line).length > 0;
    return isStored && !isStoredRightAngled(machine, "R/G", line) ? [line.id] : [];
  });
}

type Change = (machine: Machine, chosen: readonly string[], by: Point) => Planned;

const grown = (machine: Machine, path: string, by: Point): Box => {
  const box = boxIn(machine, path);
  return { ...box, width: box.width + Math.abs(by.x), height: box.height + Math.abs(by.y) };
};

const CHANGES: readonly (readonly [string, Change])[] = [
  ["moved", (machine, chosen, by) => move(machine, chosen, by)],
  ["aligned", (machine, chosen) => align(machine, chosen, "middle")],
  ["distributed", (machine, chosen) => distribute(machine, chosen, "vertical")],
  ["resized", (machine, [path = ""], by) => resize(machine, path, grown(machine, path, by), false)],
  [
    "resized from above",
    (machine, [path = ""], by) => {
      const { y, height, ...box } = boxIn(machine, path);
      const wanted = { ...box, y: y - Math.abs(by.y), height: height + Math.abs(by.y) };
      return resize(machine, path, wanted, false);
    },
  ],
  [
    "given other ports",
    (machine, [path = ""], by) => movePort(machine, { kind: "outcome", path, id: 0 }, by),
  ],
  [
    "in a container of another size",
    (machine, _, by) => resize(machine, "R/G", grown(machine, "R/G", by), false),
  ],
  [
    "in a container that is scaled",
    (machine, _, by) => resize(machine, "R/G", grown(machine, "R/G", by), true),
  ],
];

const WAYS = fc.record({
  x: fc.double({ min: -80, max: 80, noNaN: true }),
  y: fc.double({ min: -80, max: 80, noNaN: true }),
});

test.each(CHANGES)("stored ways keep their right angles when states are %s", (_, change) => {
  fc.assert(
    fc.property(SHAPES, fc.uniqueArray(fc.nat(8), { minLength: 1 }), WAYS, (shape, chosen, by) => {
      const machine = machineOfShape(shape);
      expect(slanted(machine)).toEqual([]);
      const paths = chosen.filter((at) => at < shape.places.length).map((at) => `R/G/S${at}`);
      const plan = change(machine, paths, by);
      if (isRefused(plan)) return;
      apply(machine, [plan.edit]);
      expect(slanted(machine)).toEqual([]);
    }),
  );
});

/** Waypoints by transition that a plan writes into a container. */
function written(plan: Planned, path: string): ReadonlyMap<number, number> {
  if (isRefused(plan)) return new Map();
  const edits = plan.edit.edit === "batch" ? plan.edit.edits : [plan.edit];
  return new Map(
    edits.flatMap((edit) => {
      if (edit.edit !== "set_waypoints" || edit.path !== path) return [];
      const { element } = edit;
      const id = typeof element === "object" && "transition" in element ? element.transition : -1;
      return [[id, edit.waypoints.length] as const];
    }),
  );
}

test("of a group only whole ways between its states stay", () => {
  fc.assert(
    fc.property(SHAPES, fc.uniqueArray(fc.nat(8), { minLength: 1 }), (shape, chosen) => {
      const machine = machineOfShape(shape);
      const ids = chosen.filter((at) => at < shape.places.length).map((at) => `S${at}`);
      const plan = group(
        machine,
        ids.map((id) => `R/G/${id}`),
      );
      if (isRefused(plan)) return;
      const outer = written(plan, "R/G");
      expect([...outer.values()].every((count) => count === 0)).toBe(true);
      for (const line of transitionsOf(
        machine.state("R/G") ?? { path: "", name: "", kind: "hierarchy" },
      )) {
        const [leaves, enters] = [
          line.from_state,
          line.to_outcome == null ? line.to_state : null,
        ].map((id) => ids.includes(id ?? ""));
        const isSecond = leaves && !enters && !outer.has(line.id);
        if (leaves !== enters && !isSecond) expect(outer.get(line.id)).toBe(0);
      }
    }),
  );
});

test("an ungrouped state leaves only whole ways between its children", () => {
  fc.assert(
    fc.property(SHAPES, (shape) => {
      const machine = machineOfShape(shape);
      const plan = ungroup(machine, "R/G");
      const kept = [...written(plan, "R").values()];
      expect(kept.every((count) => count === 0 || count === 2)).toBe(true);
    }),
  );
});
