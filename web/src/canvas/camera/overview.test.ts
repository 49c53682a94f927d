import { expect, test } from "vitest";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { type GhostMachine, MODES } from "../../store/page/view.ts";
import { layoutTreeOf } from "../layout/layout_tree.ts";
import { PLAIN } from "../scene/input.ts";
import { overview } from "./overview.ts";

const MACHINE = machineOf(
  sketch(`
    R "Root" hierarchy 0 0 800 600
      H "Here" hierarchy 100 50 400 400
  `),
);
const OFFERED = machineOf(
  sketch(`
    P "Plan" hierarchy 40 20 300 200 outcome success
      A "Drive" execution 30 50 100 80 outcome success
  `),
);
const GHOST: GhostMachine = { container: "R/H", machine: OFFERED, chosen: null };

function boxes(ghost: GhostMachine | null) {
  const list = overview({
    layout: layoutTreeOf(MACHINE, { modes: MODES, contents: new Map() }),
    camera: { x: 0, y: 0, scale: 0.5 },
    view: { width: 400, height: 300 },
    modes: MODES,
    runs: PLAIN.runs,
    ghost,
    line: 4,
  });
  for (const { lines, texts, dots } of list.layers) {
    expect([...lines, ...texts, ...dots]).toEqual([]);
  }
  return list.layers.flatMap((layer) => layer.boxes);
}

test("a machine that is offered is to be seen from afar, where it would stand", () => {
  const plan = boxes(GHOST).find(({ what }) => what === "ghost state:P");
  expect(plan).toMatchObject({ x: 70, y: 35, width: 150, height: 100 });
  expect(plan).toMatchObject({ stroke: "selection", dash: false, line: 10, alpha: 1 });
  expect(boxes(GHOST).some(({ what }) => what === "ghost state:P/A")).toBe(true);
});

test("where nothing is offered there is the machine only", () => {
  const names = boxes(null).map(({ what }) => what);
  expect(names).toEqual(expect.arrayContaining(["state:R", "state:R/H"]));
  expect(names.some((what) => what.startsWith("ghost "))).toBe(false);
});
