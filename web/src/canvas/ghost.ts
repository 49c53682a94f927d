/** Preview of a proposed machine at its future position. Its marks are drawn above all others, pale and dashed. */

import { elementOf } from "../model/element.ts";
import type { Box } from "../model/geometry.ts";
import { childBox, rootSize } from "../model/layout_reader.ts";
import type { GhostMachine } from "../store/page/view.ts";
import { type LayoutTree, layoutTreeOf } from "./layout/layout_tree.ts";
import { NO_OVERLAY } from "./overlay.ts";
import { PLAIN, type SceneInput } from "./scene/input.ts";
import type { BoxMark, DrawList, Layer } from "./scene/list.ts";
import { scene } from "./scene/scene.ts";

/** Opacity of its marks, relative to those of the machine. */
const PALE = 0.85;

interface GhostPlace {
  readonly layout: LayoutTree;
  /** Position of its root, in the coordinates of the shown machine's root. */
  readonly x: number;
  readonly y: number;
  /** Units of the shown machine's root per unit of the preview. */
  readonly unit: number;
}

/** Position and layout of the preview; null if its container is not visible. */
function placeOf(
  shown: LayoutTree,
  { container, machine }: GhostMachine,
  {
    modes,
    contents,
  }: Pick<SceneInput, "modes"> & { readonly contents: ReadonlyMap<string, boolean> },
): GhostPlace | null {
  const frame = shown.frame(container);
  const root = machine.state(machine.root);
  if (!frame || !root) return null;
  const box = childBox(root, 0, rootSize(root));
  return {
    layout: layoutTreeOf(machine, { modes, contents }),
    x: frame.x + box.x * frame.unit,
    y: frame.y + box.y * frame.unit,
    unit: frame.unit,
  };
}

const NOTHING_OPEN: ReadonlyMap<string, boolean> = new Map();

/** Box of a state of the preview, in the coordinates of the shown machine's root. */
export function ghostBox(shown: LayoutTree, ghost: GhostMachine, path: string): Box | undefined {
  const place = placeOf(shown, ghost, { modes: GHOST_MODES, contents: NOTHING_OPEN });
  const box = place?.layout.box(path);
  if (!place || !box) return undefined;
  const { x, y, unit } = place;
  return {
    x: x + box.x * unit,
    y: y + box.y * unit,
    width: box.width * unit,
    height: box.height * unit,
  };
}

const GHOST_MODES: SceneInput["modes"] = {
  transitions: true,
  dataFlows: "none",
  portNames: true,
  values: false,
  aborted: false,
  grid: false,
};

/** Layers of the preview in the picture of the shown machine. */
export function ghostLayers(
  input: SceneInput,
  ghost: GhostMachine,
): Pick<DrawList, "layers" | "unfinished"> {
  const modes = { ...GHOST_MODES, transitions: input.modes.transitions };
  const place = placeOf(input.layout, ghost, { modes, contents: NOTHING_OPEN });
  if (!place) return { layers: [], unfinished: false };
  const { camera } = input;
  const { x, y, unit } = place;
  const { layers, unfinished } = scene({
    ...PLAIN,
    layout: place.layout,
    camera: { x: (camera.x - x) / unit, y: (camera.y - y) / unit, scale: camera.scale * unit },
    view: input.view,
    modes,
    overlay: NO_OVERLAY,
    selection: ghost.chosen === null ? PLAIN.selection : new Set([`state:${ghost.chosen}`]),
    measure: input.measure,
    mayRoute: input.mayRoute,
  });
  return { layers: layers.map(pale), unfinished };
}

function pale(layer: Layer): Layer {
  const soft = <T extends { readonly alpha: number }>(mark: T): T => ({
    ...mark,
    alpha: mark.alpha * PALE,
  });
  return {
    under: layer.under.map((mark) => ({ ...soft(mark), dash: true })),
    specks: layer.specks.map(soft),
    boxes: layer.boxes.map(dashed),
    lines: layer.lines.map((mark) => ({ ...soft(mark), dash: true })),
    // The preview cannot be edited.
    dots: layer.dots.filter(({ shape }) => shape !== "handle").map(soft),
    icons: layer.icons.map(soft),
    texts: layer.texts.map(soft),
  };
}

/** Boxes of states become dashed and tinted; other boxes become pale. */
function dashed(mark: BoxMark): BoxMark {
  const isState = elementOf(mark.what)?.kind === "state";
  const tinted = isState && mark.stroke !== null ? { dash: true, stroke: "selection" } : {};
  return { ...mark, ...tinted, what: `ghost ${mark.what}`, alpha: mark.alpha * PALE };
}
