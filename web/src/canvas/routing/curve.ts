/** Shape of a data flow: a smooth curve that leaves and enters its ports at right angles, or follows the author's waypoints. */

import { distance, type Point } from "../../model/geometry.ts";
import { boxOf, longestOf, type Routed, type RouteEnd } from "./route.ts";

/** Straight pieces of a curve. More would not appear smoother. */
const PIECES = 16;

/** `reach` limits the detour that the curve takes to turn around. */
export function curve(
  start: RouteEnd,
  goal: RouteEnd,
  by: readonly Point[],
  reach: number,
): Routed {
  const points = by.length > 0 ? [start.at, ...by, goal.at] : bent(start, goal, reach);
  return {
    points,
    waypoints: by.map((_, index) => index + 1),
    longest: by.length > 0 ? longestOf(points) : points.length >> 1,
    box: boxOf(points),
  };
}

function bent(start: RouteEnd, goal: RouteEnd, reach: number): readonly Point[] {
  const first = led(start, goal.at, reach);
  const second = led(goal, start.at, reach);
  return Array.from({ length: PIECES + 1 }, (_, piece) =>
    bezier(start.at, first, second, goal.at, piece / PIECES),
  );
}

/** Control point outside a port: half the distance ahead, or up to `reach` if the other end is behind the port. */
function led({ at, out }: RouteEnd, other: Point, reach: number): Point {
  const ahead = (other.x - at.x) * out.x + (other.y - at.y) * out.y;
  const pull = ahead > 0 ? Math.max(ahead * 0.5, reach * 0.5) : reach;
  const length = Math.min(pull, distance(at, other));
  return { x: at.x + out.x * length, y: at.y + out.y * length };
}

function bezier(from: Point, first: Point, second: Point, to: Point, part: number): Point {
  const rest = 1 - part;
  const [a, b, c, d] = [rest ** 3, 3 * rest ** 2 * part, 3 * rest * part ** 2, part ** 3];
  return {
    x: a * from.x + b * first.x + c * second.x + d * to.x,
    y: a * from.y + b * first.y + c * second.y + d * to.y,
  };
}
