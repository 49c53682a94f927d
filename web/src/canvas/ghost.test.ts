import { expect, test } from "vitest";
import { machineOf } from "../model/plain_machine.ts";
import { sketch } from "../model/testing/sketch.ts";
import { type GhostMachine, MODES } from "../store/page/view.ts";
import { ghostBox, ghostLayers } from "./ghost.ts";
import { layoutTreeOf } from "./layout/layout_tree.ts";
import { NO_OVERLAY } from "./overlay.ts";
import { PLAIN, type SceneInput } from "./scene/input.ts";

const MACHINE = machineOf(
  sketch(`
    R "Root" hierarchy 0 0 800 600
      H "Here" hierarchy 100 50 400 400
  `),
);

/** Stands in `Here` at 40, 20. */
const OFFERED = machineOf(
  sketch(`
    P "Plan" hierarchy 40 20 300 200 outcome success
      A "Drive" execution 30 50 100 80 outcome success
      B "Pick" execution 160 50 100 80 outcome success
      P > A
      A.success > B
      B.success > P.success
  `),
);

const layout = layoutTreeOf(MACHINE, { modes: MODES, contents: new Map() });

function input(scale: number): SceneInput {
  return {
    ...PLAIN,
    layout,
    camera: { x: 0, y: 0, scale },
    view: { width: 800, height: 600 },
    modes: MODES,
    overlay: NO_OVERLAY,
    measure: (text) => text.length * 6,
  };
}

function ghost(changed: Partial<GhostMachine> = {}): GhostMachine {
  return { container: "R/H", machine: OFFERED, chosen: null, ...changed };
}

test("its states stand where they would stand in the container", () => {
  expect(ghostBox(layout, ghost(), "P")).toEqual({ x: 140, y: 70, width: 300, height: 200 });
  expect(ghostBox(layout, ghost(), "P/B")).toEqual({ x: 300, y: 120, width: 100, height: 80 });
  expect(ghostBox(layout, ghost({ container: "R/GONE" }), "P")).toBeUndefined();
});

test("it is drawn there, dashed, by names and lines, in every zoom", () => {
  for (const scale of [1, 2]) {
    const { layers } = ghostLayers(input(scale), ghost());
    const boxes = layers.flatMap((layer) => layer.boxes);
    const box = boxes.find(({ what }) => what === "ghost state:P/A");
    const [x, y, width, height] = [170, 120, 100, 80].map((each) => each * scale);
    expect(box).toMatchObject({ x, y, width, height, dash: true, stroke: "selection" });
    const lines = layers.flatMap((layer) => layer.lines);
    expect(lines.length).toBeGreaterThanOrEqual(3);
    expect(lines.every(({ dash }) => dash)).toBe(true);
    const texts = layers.flatMap((layer) => layer.texts.map(({ text }) => text));
    expect(texts).toEqual(expect.arrayContaining(["Plan", "Drive", "Pick"]));
  }
});

test("where its container is gone nothing is drawn", () => {
  expect(ghostLayers(input(1), ghost({ container: "R/GONE" })).layers).toEqual([]);
});
