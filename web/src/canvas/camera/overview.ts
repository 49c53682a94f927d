/** Content of the minimap: only boxes, of the machine and of a proposed one. */

import type { GhostMachine } from "../../store/page/view.ts";
import { ghostLayers } from "../ghost.ts";
import { NO_OVERLAY } from "../overlay.ts";
import { PLAIN, type SceneInput } from "../scene/input.ts";
import type { BoxMark, DrawList, Layer } from "../scene/list.ts";
import { scene } from "../scene/scene.ts";

interface OverviewShown extends Pick<SceneInput, "layout" | "camera" | "view" | "modes" | "runs"> {
  readonly ghost: GhostMachine | null;
  /** Pixels of the minimap's canvas per visible pixel. */
  readonly line: number;
}

const QUIET = { transitions: false, dataFlows: "none", portNames: false } as const;
/** Width of the outline of boxes that need attention. */
const LOUD_LINE = 2.5;

export function overview({ ghost, line, ...shown }: OverviewShown): DrawList {
  const input: SceneInput = {
    ...PLAIN,
    ...shown,
    modes: { ...shown.modes, ...QUIET },
    overlay: NO_OVERLAY,
    measure: () => 0,
    mayRoute: () => false,
  };
  const list = scene(input);
  const offered = ghost ? ghostLayers(input, ghost).layers : [];
  const layers = [...list.layers, ...offered].map((layer) => boxesOnly(layer, LOUD_LINE * line));
  return { ...list, layers };
}

function boxesOnly(layer: Layer, loud: number): Layer {
  const boxes = layer.boxes.map((box) => asLarge(box, loud));
  return { ...layer, boxes, dots: [], icons: [], texts: [], lines: [], under: [] };
}

/** Gives boxes that wait for a person, and proposed boxes, a solid wide outline. Dashes would be too fine. */
function asLarge(box: BoxMark, line: number): BoxMark {
  const isOffered = box.what.startsWith("ghost ") && box.stroke !== null;
  const isLoud = box.stroke === "waiting" || isOffered;
  return isLoud ? { ...box, dash: false, line, alpha: 1 } : box;
}
