/** The way of a data flow: a soft curve that leaves and enters its ports at right angles, or the author's waypoints. */

import { around, distance, type Point } from "../model/geometry.ts";
import { type End, longestOf, type Routed } from "./route.ts";

/** So many straight pieces look round. */
const PIECES = 16;

export function curve(start: End, goal: End, by: readonly Point[]): Routed {
  const points = by.length > 0 ? [start.at, ...by, goal.at] : bent(start, goal);
  return {
    points,
    waypoints: by.map((_, index) => index + 1),
    longest: by.length > 0 ? longestOf(points) : points.length >> 1,
    box: around(points.map((point) => ({ ...point, width: 0, height: 0 }))) ?? NOWHERE,
  };
}

const NOWHERE = { x: 0, y: 0, width: 0, height: 0 };

function bent(start: End, goal: End): readonly Point[] {
  const pull = distance(start.at, goal.at) * 0.4;
  const first = { x: start.at.x + start.out.x * pull, y: start.at.y + start.out.y * pull };
  const second = { x: goal.at.x + goal.out.x * pull, y: goal.at.y + goal.out.y * pull };
  return Array.from({ length: PIECES + 1 }, (_, piece) =>
    bezier(start.at, first, second, goal.at, piece / PIECES),
  );
}

function bezier(from: Point, first: Point, second: Point, to: Point, part: number): Point {
  const rest = 1 - part;
  const [a, b, c, d] = [rest ** 3, 3 * rest ** 2 * part, 3 * rest * part ** 2, part ** 3];
  return {
    x: a * from.x + b * first.x + c * second.x + d * to.x,
    y: a * from.y + b * first.y + c * second.y + d * to.y,
  };
}
