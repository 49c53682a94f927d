/** Distances of points from lines. */

import { distance, type Point } from "../../model/geometry.ts";
import type { Camera } from "../../store/page/view.ts";
import type { Route } from "../layout/layout.ts";

/** Distance in CSS pixels between a point of the view and a line in the root's coordinates. */
export function distanceToLine(points: readonly Point[], point: Point, camera: Camera): number {
  let best = Number.POSITIVE_INFINITY;
  let before: Point | undefined;
  for (const { x, y } of points) {
    const next = { x: (x - camera.x) * camera.scale, y: (y - camera.y) * camera.scale };
    if (before) best = Math.min(best, distance(nearestOn(before, next, point), point));
    before = next;
  }
  return best;
}

/** Point on a line segment that is nearest to another point. */
export function nearestOn(from: Point, to: Point, point: Point): Point {
  const [dx, dy] = [to.x - from.x, to.y - from.y];
  const length = dx * dx + dy * dy;
  if (length === 0) return from;
  const part = ((point.x - from.x) * dx + (point.y - from.y) * dy) / length;
  const kept = Math.min(1, Math.max(0, part));
  return { x: from.x + dx * kept, y: from.y + dy * kept };
}

/** Points where dragging a route adds a waypoint: the middle of each part except the short stubs at ports. */
export function middlesOf(route: Route): readonly { readonly at: Point; readonly index: number }[] {
  const whole = lengthOf(route.points);
  const found: { at: Point; index: number }[] = [];
  let index = 0;
  for (let corner = 0; corner + 1 < route.points.length; corner++) {
    if (route.waypoints.includes(corner)) index++;
    const [from, to] = [route.points[corner], route.points[corner + 1]];
    if (!from || !to || distance(from, to) < whole * 0.12) continue;
    found.push({ at: { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 }, index });
  }
  return found;
}

/** Index of a new waypoint on the part of the route that is nearest to a point of the view. */
export function nearestPart(route: Route, point: Point, camera: Camera): number {
  let [best, least, index] = [0, Number.POSITIVE_INFINITY, 0];
  for (let corner = 0; corner + 1 < route.points.length; corner++) {
    if (route.waypoints.includes(corner)) index++;
    const away = distanceToLine(route.points.slice(corner, corner + 2), point, camera);
    if (away < least) [best, least] = [index, away];
  }
  return best;
}

function lengthOf(points: readonly Point[]): number {
  let sum = 0;
  for (let at = 1; at < points.length; at++) {
    const [from, to] = [points[at - 1], points[at]];
    if (from && to) sum += distance(from, to);
  }
  return sum;
}
