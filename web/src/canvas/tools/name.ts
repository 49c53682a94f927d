/** Moves and resizes the box of a name, within its state. */

import type { Box, Point } from "../../model/geometry.ts";
import { moveName, resizeName } from "../../plan/move.ts";
import { showing } from "../overlay.ts";
import {
  type Gesture,
  inState,
  minus,
  type Pointer,
  type ToolContext,
  worldOf,
} from "./gesture.ts";

interface Naming {
  readonly path: string;
  readonly corner: boolean;
  readonly from: Point;
  /** Box in the state's own coordinates, which all values here use. */
  readonly box: Box;
  readonly state: Box;
}

/** Starts to move the name of a state, or to resize its box by the lower right corner. */
export function naming(
  path: string,
  corner: boolean,
  pressed: Pointer,
  context: ToolContext,
): Gesture {
  const { layout } = context;
  const unit = layout.unit(path);
  const [name, state] = [layout.name(path), layout.box(path)];
  const own = (box: Box | undefined): Box =>
    box
      ? { ...inState(layout, path, box), width: box.width / unit, height: box.height / unit }
      : { x: 0, y: 0, width: 1, height: 1 };
  const from = inState(layout, path, worldOf(pressed, context));
  return next({ path, corner, from, box: own(name), state: own(state) }, pressed, context);
}

function next(start: Naming, pointer: Pointer, context: ToolContext): Gesture {
  const by = minus(inState(context.layout, start.path, worldOf(pointer, context)), start.from);
  const box = start.corner ? resized(start, by) : moved(start, by);
  const plan = (start.corner ? resizeName : moveName)(context.machine, start.path, box);
  return {
    name: "name",
    cursor: start.corner ? "nwse-resize" : "grabbing",
    overlay: { ...showing(plan), ghosts: [inRoot(start, box, context)] },
    move: (then, there) => next(start, then, there),
    result: () => (by.x === 0 && by.y === 0 ? {} : { plan }),
  };
}

/** Box of the name in the root's coordinates, shown as a preview of its size. */
function inRoot({ path }: Naming, box: Box, { layout }: ToolContext): Box {
  const state = layout.box(path) ?? box;
  const unit = layout.unit(path);
  return {
    x: state.x + box.x * unit,
    y: state.y + box.y * unit,
    width: box.width * unit,
    height: box.height * unit,
  };
}

function moved({ box, state }: Naming, by: Point): Box {
  return {
    ...box,
    x: Math.min(Math.max(box.x + by.x, 0), Math.max(0, state.width - box.width)),
    y: Math.min(Math.max(box.y + by.y, 0), Math.max(0, state.height - box.height)),
  };
}

/** Resized box, at least an eighth of the state, as in the reference. */
function resized({ box, state }: Naming, by: Point): Box {
  const [width, height] = [box.width + by.x, box.height + by.y];
  return {
    ...box,
    width: Math.min(Math.max(width, state.width / 8), state.width - box.x),
    height: Math.min(Math.max(height, state.height / 8), state.height - box.y),
  };
}
