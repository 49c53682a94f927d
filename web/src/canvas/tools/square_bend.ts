/** Bends a line with right angles by hand: one of its pieces, or the corner between two, follows the pointer, and all pieces stay
 * upright or level. */

import { distance, type Point } from "../../model/geometry.ts";
import { isExactlyRightAngled } from "../../plan/right_angles.ts";
import { nearestOn } from "../hit/lines.ts";

/** Dragged part of a line, by its index among the pieces or corners. */
export interface SquareBend {
  /** Points from port to port, only one at each bend. */
  readonly points: readonly Point[];
  readonly part: "piece" | "corner";
  readonly index: number;
}

/** Part of a line that is dragged from a point; null if the line has slanted pieces. */
export function squareBend(
  points: readonly Point[],
  at: Point,
  part: SquareBend["part"],
): SquareBend | null {
  const bends = withoutStraight(points);
  if (bends.length < 2 || !isExactlyRightAngled(bends)) return null;
  const isCorner = part === "corner" && bends.length > 2;
  const away = bends.slice(0, -1).map((from, index) => {
    const to = bends[index + 1] ?? from;
    return isCorner && index > 0 ? distance(from, at) : distance(nearestOn(from, to, at), at);
  });
  if (isCorner) away[0] = Number.POSITIVE_INFINITY;
  const index = away.indexOf(Math.min(...away));
  return { points: bends, part: isCorner ? "corner" : "piece", index };
}

/** Waypoints of the line with the part at the pointer. A part closer than `reach` to another piece joins it. */
export function bentSquare({ points, part, index }: SquareBend, to: Point, reach: number): Point[] {
  const moved = part === "corner" ? cornerAt(points, index, to) : pieceAt(points, index, to, reach);
  return withoutStraight(moved).slice(1, -1);
}

/** Moves a corner. The ends stay at their ports: a corner beside one slides along the first or last piece. */
function cornerAt(points: readonly Point[], index: number, to: Point): readonly Point[] {
  const [before, corner, after] = [points[index - 1], points[index], points[index + 1]];
  if (!before || !corner || !after) return points;
  const entersLevel = isLevel(before, corner);
  const isFixed = { before: index === 1, after: index + 2 === points.length };
  const along = entersLevel ? "y" : "x";
  const across = entersLevel ? "x" : "y";
  const at = {
    ...to,
    ...(isFixed.before ? { [along]: corner[along] } : {}),
    ...(isFixed.after ? { [across]: corner[across] } : {}),
  };
  return points.map((point, number) => {
    if (number === index) return at;
    if (number === index - 1 && !isFixed.before) return { ...point, [along]: at[along] };
    if (number === index + 1 && !isFixed.after) return { ...point, [across]: at[across] };
    return point;
  });
}

/** Moves a piece. A piece at a port leaves a short one there. */
function pieceAt(
  points: readonly Point[],
  index: number,
  to: Point,
  reach: number,
): readonly Point[] {
  const [from, until] = [points[index], points[index + 1]];
  if (!from || !until) return points;
  const across = isLevel(from, until) ? "y" : "x";
  const near = [points[0], points.at(-1), points[index - 1], points[index + 2]]
    .flatMap((point) => point?.[across] ?? [])
    .find((other) => Math.abs(other - to[across]) < reach);
  const place = near ?? to[across];
  const stub = Math.min(distance(from, until) / 4, 3 * reach);
  const piece = [
    ...(index === 0 ? [from, between(from, until, stub)] : []),
    { ...(index === 0 ? between(from, until, stub) : from), [across]: place },
    ...(index + 2 === points.length
      ? [{ ...between(until, from, stub), [across]: place }, between(until, from, stub), until]
      : [{ ...until, [across]: place }]),
  ];
  return [...points.slice(0, index), ...piece, ...points.slice(index + 2)];
}

function isLevel(from: Point, to: Point): boolean {
  return Math.abs(from.y - to.y) <= Math.abs(from.x - to.x);
}

function between(from: Point, to: Point, length: number): Point {
  const part = length / (distance(from, to) || 1);
  return { x: from.x + (to.x - from.x) * part, y: from.y + (to.y - from.y) * part };
}

/** Ends, and points at which the direction changes. */
function withoutStraight(points: readonly Point[]): readonly Point[] {
  const kept: Point[] = [];
  for (const point of points) {
    const [before, last] = [kept.at(-2), kept.at(-1)];
    if (last && isExactlyRightAngled([last, point]) && distance(last, point) < TINY * size(point)) {
      continue;
    }
    if (before && last && isAhead(before, last, point)) kept.pop();
    kept.push(point);
  }
  return kept;
}

/** Rounding error, as a share of a coordinate. */
const TINY = 1e-6;

function size({ x, y }: Point): number {
  return Math.max(Math.abs(x), Math.abs(y), 1e-9);
}

function isAhead(before: Point, last: Point, next: Point): boolean {
  const turn = (last.x - before.x) * (next.y - last.y) - (last.y - before.y) * (next.x - last.x);
  return Math.abs(turn) <= TINY * distance(before, last) * distance(last, next);
}
