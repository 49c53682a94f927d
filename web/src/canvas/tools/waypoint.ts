/** Adds, moves and merges waypoints of a connection. A line at right angles keeps its right angles unless Shift is pressed. */

import { type Box, distance, type Point } from "../../model/geometry.ts";
import { waypointsOf } from "../../model/layout_reader.ts";
import { setWaypoints } from "../../plan/move.ts";
import { routeOf } from "../hit/hit.ts";
import { nearestOn } from "../hit/lines.ts";
import type { LineRef } from "../hit/look.ts";
import { showing } from "../overlay.ts";
import { type Gesture, inState, type Pointer, type ToolContext, worldOf } from "./gesture.ts";
import { bentSquare, type SquareBend, squareBend } from "./square_bend.ts";

interface Bending {
  readonly element: LineRef;
  readonly index: number;
  /** True if the waypoint existed before the gesture. */
  readonly isOld: boolean;
  /** Other waypoints before and after it, in the container's coordinates. */
  readonly before: readonly Point[];
  readonly after: readonly Point[];
  /** Dragged part of a line with right angles; null for other lines. */
  readonly square: SquareBend | null;
  /** Ends of the connection, in the container's coordinates. */
  readonly first: Point;
  readonly last: Point;
}

/** Starts to drag a waypoint: an existing one, or one that is added at this index. */
export function bending(
  element: LineRef,
  index: number,
  isOld: boolean,
  pressed: Pointer,
  context: ToolContext,
): Gesture {
  const { machine, layout } = context;
  const state = machine.state(element.path);
  const all = state ? waypointsOf(state, element.kind, element.id) : [];
  const points = routeOf(layout, element)?.points ?? [];
  const end = (at: Point | undefined) =>
    inState(layout, element.path, at ?? worldOf(pressed, context));
  const corners = element.kind === "transition" ? points.map(end) : [];
  const start: Bending = {
    element,
    index,
    isOld,
    square: squareBend(corners, end(undefined), isOld ? "corner" : "piece"),
    before: all.slice(0, index),
    after: all.slice(isOld ? index + 1 : index),
    first: end(points[0]),
    last: end(points.at(-1)),
  };
  return next(start, pressed, context);
}

/** Distance from the straight line at which a waypoint is removed, in CSS pixels. */
const MERGE = 6;

function next(start: Bending, pointer: Pointer, context: ToolContext): Gesture {
  const { element, before, after } = start;
  const at = placed(start, pointer, context);
  if (start.square && !pointer.shift) return bentAtRightAngles(start, start.square, at, context);
  const isMerged = isStraight(start, at, context);
  const points = isMerged ? [...before, ...after] : [...before, at, ...after];
  const plan = setWaypoints(context.machine, element, points);
  return {
    name: "waypoint",
    cursor: "grabbing",
    overlay: showing(plan),
    move: (then, there) => next(start, then, there),
    result: () => (isMerged && !start.isOld ? {} : { plan }),
  };
}

function bentAtRightAngles(
  start: Bending,
  square: SquareBend,
  at: Point,
  context: ToolContext,
): Gesture {
  const { element } = start;
  const { machine, layout, camera } = context;
  const points = bentSquare(square, at, MERGE / (layout.unit(element.path) * camera.scale));
  const plan = setWaypoints(machine, element, points);
  const isNew = points.length > 0 || start.before.length + start.after.length > 0 || start.isOld;
  return {
    name: "waypoint",
    cursor: "grabbing",
    overlay: showing(plan),
    move: (then, there) => next(start, then, there),
    result: () => (isNew ? { plan } : {}),
  };
}

/** Position inside the container. With Shift, its direction from the point before or after is a multiple of 45°. */
function placed(start: Bending, pointer: Pointer, context: ToolContext): Point {
  const { layout } = context;
  const { path } = start.element;
  const free = inState(layout, path, worldOf(pointer, context));
  const at = pointer.shift ? even(neighbour(start, free), free) : free;
  const box = layout.box(path);
  const unit = layout.unit(path);
  return box
    ? boundedIn(at, { x: 0, y: 0, width: box.width / unit, height: box.height / unit })
    : at;
}

function ends({ before, after, first, last }: Bending): readonly [Point, Point] {
  return [before.at(-1) ?? first, after[0] ?? last];
}

/** Nearer of the points before and after. */
function neighbour(start: Bending, at: Point): Point {
  const [one, other] = ends(start);
  return distance(one, at) <= distance(other, at) ? one : other;
}

const EIGHTH = Math.PI / 4;

/** Point projected onto the nearest of eight directions from another point. */
export function even(from: Point, to: Point): Point {
  const angle = Math.round(Math.atan2(to.y - from.y, to.x - from.x) / EIGHTH) * EIGHTH;
  const [x, y] = [Math.cos(angle), Math.sin(angle)];
  const length = (to.x - from.x) * x + (to.y - from.y) * y;
  return { x: from.x + x * length, y: from.y + y * length };
}

function boundedIn(at: Point, box: Box): Point {
  return {
    x: Math.min(Math.max(at.x, box.x), box.x + box.width),
    y: Math.min(Math.max(at.y, box.y), box.y + box.height),
  };
}

function isStraight(start: Bending, at: Point, { layout, camera }: ToolContext): boolean {
  const [from, to] = ends(start);
  const away = distance(nearestOn(from, to, at), at) * layout.unit(start.element.path);
  return away * camera.scale < MERGE;
}
