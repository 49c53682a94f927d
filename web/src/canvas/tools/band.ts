/** Rubber band: selects the elements that lie entirely inside it. */

import { type ElementRef, keyOf } from "../../model/element.ts";
import { type Box, contains, intersects, type Point } from "../../model/geometry.ts";
import { withLines } from "../hit/hit.ts";
import { childrenIn, inFrame } from "../hit/near.ts";
import { extentOn, isRouteShown } from "../hit/shown.ts";
import { type NodeFrame, pointAt } from "../layout/layout_tree.ts";
import { NO_OVERLAY } from "../overlay.ts";
import { DETAIL } from "../scene/detail.ts";
import { type Gesture, type Pointer, type ToolContext, worldOf } from "./gesture.ts";

/** Starts a rubber band at the pressed point. The elements in `kept` stay selected. */
export function banding(
  pressed: Pointer,
  context: ToolContext,
  kept: readonly ElementRef[] = [],
): Gesture {
  return next(worldOf(pressed, context), kept, pressed, context);
}

function next(
  from: Point,
  kept: readonly ElementRef[],
  pointer: Pointer,
  context: ToolContext,
): Gesture {
  const to = worldOf(pointer, context);
  const band: Box = {
    x: Math.min(from.x, to.x),
    y: Math.min(from.y, to.y),
    width: Math.abs(to.x - from.x),
    height: Math.abs(to.y - from.y),
  };
  const found = [...kept, ...enclosed(band, context)];
  const targets = new Map(found.map((element) => [keyOf(element), true] as const));
  return {
    name: "band",
    cursor: "crosshair",
    overlay: { ...NO_OVERLAY, band, targets },
    move: (then, there) => next(from, kept, then, there),
    result: () => ({ select: found }),
  };
}

/** States and connections entirely inside the box. Children of an enclosed state are left out. */
export function enclosed(band: Box, context: ToolContext): readonly ElementRef[] {
  const found: ElementRef[] = [];
  collect(context.machine.root, band, context, found);
  return found;
}

function collect(path: string, band: Box, context: ToolContext, found: ElementRef[]): void {
  const { layout, camera } = context;
  const box = layout.box(path);
  if (!box || !intersects(box, band)) return;
  if (extentOn(camera, box) < DETAIL.box) return;
  if (isIn(box, band)) {
    found.push({ kind: "state", path });
    return;
  }
  for (const child of childrenIn(layout, path, band)) collect(child, band, context, found);
  const frame = layout.frame(path);
  if (frame) collectLines(frame, band, context, found);
}

function collectLines(
  frame: NodeFrame,
  band: Box,
  context: ToolContext,
  found: ElementRef[],
): void {
  const { path } = frame.at;
  withLines(frame.at).eachLine(inFrame(frame, band), ({ kind, id, points, waypoints }) => {
    const corners = points.map((point) => pointAt(frame, point));
    if (!corners.every((point) => contains(band, point))) return;
    const route = { kind, path, id, points: corners, waypoints };
    if (isRouteShown(route, context)) found.push({ kind, path, id });
  });
}

function isIn(box: Box, band: Box): boolean {
  return contains(band, box) && contains(band, { x: box.x + box.width, y: box.y + box.height });
}
