/** Resizes a state by a corner or side. With Ctrl its content is scaled along, with Shift the aspect ratio stays. */

import type { Box, Point } from "../../model/geometry.ts";
import { parentOf } from "../../model/path.ts";
import { boxEdits } from "../../plan/boxes.ts";
import { allowedBox, resize } from "../../plan/move.ts";
import { together } from "../../plan/plan.ts";
import type { Grip } from "../hit/look.ts";
import { NO_OVERLAY, type Overlay, showing } from "../overlay.ts";
import {
  type Gesture,
  inState,
  minus,
  type Pointer,
  type ToolContext,
  worldOf,
} from "./gesture.ts";
import { type Guides, type Lines, neighbours, snapped } from "./guides.ts";

interface Resizing {
  readonly path: string;
  readonly grip: Grip;
  readonly from: Point;
  /** Box at the start, in the root's coordinates. */
  readonly box: Box;
  /** Box of the container; null for the root. */
  readonly outer: Box | null;
  readonly others: readonly Box[];
}

/** Starts to resize a state by the pressed corner or side. */
export function resizing(
  path: string,
  grip: Grip,
  pressed: Pointer,
  context: ToolContext,
): Gesture {
  const parent = parentOf(path);
  const start: Resizing = {
    path,
    grip,
    from: worldOf(pressed, context),
    box: context.layout.box(path) ?? { x: 0, y: 0, width: 1, height: 1 },
    outer: parent === null ? null : (context.layout.box(parent) ?? null),
    others: parent === null ? [] : neighbours(context, parent, new Set([path])),
  };
  return next(start, pressed, context);
}

function next(start: Resizing, pointer: Pointer, context: ToolContext): Gesture {
  const { box, guides } = resized(start, pointer, context);
  const isSame = Object.entries(start.box).every(([key, value]) => box[key as keyof Box] === value);
  const plan = () =>
    resize(context.machine, start.path, inParent(start, box, context), pointer.ctrl);
  return {
    name: "resize",
    cursor: cursorOf(start.grip),
    overlay: isSame ? NO_OVERLAY : shown(start, box, guides, pointer, context),
    move: (to, then) => next(start, to, then),
    result: () => (isSame ? {} : { plan: plan() }),
  };
}

/** Preview of the result. The canvas itself scales the content, so that the preview needs no edit of each part. */
function shown(
  start: Resizing,
  box: Box,
  guides: Guides,
  pointer: Pointer,
  context: ToolContext,
): Overlay {
  const { machine } = context;
  const { path } = start;
  const [then, held] = [inParent(start, box, context), new Set([path])];
  if (!pointer.ctrl) return { ...showing(resize(machine, path, then, false), held), guides };
  const state = machine.state(path);
  const edits = state ? boxEdits(state, path, allowedBox(machine, path, then, true)) : [];
  return { ...NO_OVERLAY, provisional: { edit: together(edits), held, isScaled: true }, guides };
}

function inParent({ path }: Resizing, box: Box, { layout }: ToolContext): Box {
  const parent = parentOf(path);
  if (parent === null) return box;
  const unit = layout.unit(parent);
  return {
    ...inState(layout, parent, box),
    width: box.width / unit,
    height: box.height / unit,
  };
}

function resized(
  start: Resizing,
  pointer: Pointer,
  context: ToolContext,
): { readonly box: Box; readonly guides: Guides } {
  const by = minus(worldOf(pointer, context), start.from);
  if (by.x === 0 && by.y === 0) return { box: start.box, guides: [] };
  const least = leastSide(start, context);
  const free = stretched(start, by, least);
  if (pointer.shift) return { box: inForm(start, free, least), guides: [] };
  const { by: more, guides } = snapped(free, start.others, context, linesOf(start.grip));
  const total = { x: by.x + more.x, y: by.y + more.y };
  return { box: stretched(start, total, least), guides };
}

/** Smallest side: a fiftieth of the container, as in the reference; one unit for the root. */
function leastSide({ outer }: Resizing, { camera }: ToolContext): number {
  const least = outer ? Math.min(outer.width, outer.height) / 50 : 1;
  return Math.max(least, 4 / camera.scale);
}

function linesOf(grip: Grip): { readonly x: Lines; readonly y: Lines } {
  return {
    x: grip.includes("w") ? [0] : grip.includes("e") ? [1] : [],
    y: grip.includes("n") ? [0] : grip.includes("s") ? [1] : [],
  };
}

/** Box with the dragged sides moved, not smaller than allowed and not beyond the container. */
function stretched({ box, grip, outer }: Resizing, by: Point, least: number): Box {
  let [left, top, right, bottom] = [box.x, box.y, box.x + box.width, box.y + box.height];
  if (grip.includes("w")) left = Math.min(left + by.x, right - least);
  if (grip.includes("e")) right = Math.max(right + by.x, left + least);
  if (grip.includes("n")) top = Math.min(top + by.y, bottom - least);
  if (grip.includes("s")) bottom = Math.max(bottom + by.y, top + least);
  if (outer) {
    if (grip.includes("w")) left = Math.max(left, Math.min(outer.x, box.x));
    if (grip.includes("n")) top = Math.max(top, Math.min(outer.y, box.y));
    const end = { x: outer.x + outer.width, y: outer.y + outer.height };
    if (grip.includes("e")) right = Math.min(right, Math.max(end.x, box.x + box.width));
    if (grip.includes("s")) bottom = Math.min(bottom, Math.max(end.y, box.y + box.height));
  }
  return { x: left, y: top, width: right - left, height: bottom - top };
}

/** Box with its original aspect ratio, about the corner or side that stays. */
function inForm({ box, grip, outer }: Resizing, free: Box, least: number): Box {
  const isWide = grip === "e" || grip === "w";
  const isHigh = grip === "n" || grip === "s";
  const parts = [free.width / box.width, free.height / box.height] as const;
  const wanted = isWide ? parts[0] : isHigh ? parts[1] : Math.max(...parts);
  const factor = Math.max(wanted, least / Math.min(box.width, box.height));
  const then = formed(box, grip, factor);
  if (!outer || fitsIn(then, outer)) return then;
  return formed(box, grip, Math.min(...parts, factor));
}

function formed(box: Box, grip: Grip, factor: number): Box {
  const [width, height] = [box.width * factor, box.height * factor];
  const x = grip.includes("w") ? box.x + box.width - width : box.x;
  const y = grip.includes("n") ? box.y + box.height - height : box.y;
  return { x, y, width, height };
}

function fitsIn(box: Box, outer: Box): boolean {
  return (
    box.x >= outer.x &&
    box.y >= outer.y &&
    box.x + box.width <= outer.x + outer.width &&
    box.y + box.height <= outer.y + outer.height
  );
}

export function cursorOf(grip: Grip): string {
  if (grip === "n" || grip === "s") return "ns-resize";
  if (grip === "e" || grip === "w") return "ew-resize";
  return grip === "nw" || grip === "se" ? "nwse-resize" : "nesw-resize";
}
