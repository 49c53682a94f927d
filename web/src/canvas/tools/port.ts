/** Slides a port along the border of its state, around corners. */

import type { Box, Point } from "../../model/geometry.ts";
import { movePort } from "../../plan/move.ts";
import type { CanvasPort } from "../hit/look.ts";
import { NO_OVERLAY, showing } from "../overlay.ts";
import { type Gesture, inState, type Pointer, type ToolContext, worldOf } from "./gesture.ts";

/** Starts to slide a port. It stays on the border, at the point nearest to the pointer. */
export function sliding(port: CanvasPort, pointer: Pointer, context: ToolContext): Gesture {
  return next(port, null, pointer, context);
}

function next(
  port: CanvasPort,
  before: Point | null,
  pointer: Pointer,
  context: ToolContext,
): Gesture {
  const box = context.layout.box(port.path);
  const to = box && nearestOnBorder(box, worldOf(pointer, context));
  const at = to ? inState(context.layout, port.path, to) : before;
  const plan = at && movePort(context.machine, port, at);
  return {
    name: "port",
    cursor: "grabbing",
    overlay: plan ? showing(plan) : NO_OVERLAY,
    move: (then, there) => next(port, at, then, there),
    result: () => (plan ? { plan } : {}),
  };
}

/** Point on the border of a box that is nearest to a point inside or outside. */
export function nearestOnBorder(box: Box, point: Point): Point {
  const [right, bottom] = [box.x + box.width, box.y + box.height];
  const x = Math.min(right, Math.max(box.x, point.x));
  const y = Math.min(bottom, Math.max(box.y, point.y));
  if (x !== point.x || y !== point.y) return { x, y };
  const away = [x - box.x, right - x, y - box.y, bottom - y];
  const least = Math.min(...away);
  if (least === away[0]) return { x: box.x, y };
  if (least === away[1]) return { x: right, y };
  return least === away[2] ? { x, y: box.y } : { x, y: bottom };
}
