/** Path of a line with round corners, and its arrow head. */

import type { LineMark } from "../scene/list.ts";
import type { PaintContext } from "./ink.ts";

/** Adds the line to the path of the context. */
export function paintLine(context: PaintContext, { points, radius, curve, arrow }: LineMark): void {
  const last = points.length - 2;
  context.moveTo(points[0] ?? 0, points[1] ?? 0);
  for (let at = 2; at < last; at += 2) {
    if (curve) bend(context, points, at);
    else if (radius > 0) corner(context, points, at, radius);
    else context.lineTo(points[at] ?? 0, points[at + 1] ?? 0);
  }
  context.lineTo(points[last] ?? 0, points[last + 1] ?? 0);
  if (arrow > 0) head(context, points, arrow);
}

/** Curve from the middle of one piece to that of the next. */
function bend(context: PaintContext, points: readonly number[], at: number): void {
  const [x, y] = [points[at] ?? 0, points[at + 1] ?? 0];
  const [afterX, afterY] = [points[at + 2] ?? x, points[at + 3] ?? y];
  context.quadraticCurveTo(x, y, (x + afterX) / 2, (y + afterY) / 2);
}

function corner(
  context: PaintContext,
  points: readonly number[],
  at: number,
  radius: number,
): void {
  const [x, y] = [points[at] ?? 0, points[at + 1] ?? 0];
  const [beforeX, beforeY] = [points[at - 2] ?? x, points[at - 1] ?? y];
  const [afterX, afterY] = [points[at + 2] ?? x, points[at + 3] ?? y];
  const before = Math.hypot(x - beforeX, y - beforeY);
  const after = Math.hypot(x - afterX, y - afterY);
  const round = Math.min(radius, before / 2, after / 2);
  if (round < 0.75) {
    context.lineTo(x, y);
    return;
  }
  const [back, on] = [round / before, round / after];
  context.lineTo(x + (beforeX - x) * back, y + (beforeY - y) * back);
  context.quadraticCurveTo(x, y, x + (afterX - x) * on, y + (afterY - y) * on);
}

function head(context: PaintContext, points: readonly number[], length: number): void {
  const end = points.length - 2;
  const [x, y] = [points[end] ?? 0, points[end + 1] ?? 0];
  let from = end - 2;
  while (from > 0 && Math.hypot(x - (points[from] ?? x), y - (points[from + 1] ?? y)) < 1)
    from -= 2;
  const [dx, dy] = [x - (points[from] ?? x), y - (points[from + 1] ?? y)];
  const far = Math.hypot(dx, dy) || 1;
  const [ux, uy] = [(dx / far) * length, (dy / far) * length];
  context.moveTo(x - ux - uy * 0.5, y - uy + ux * 0.5);
  context.lineTo(x, y);
  context.lineTo(x - ux + uy * 0.5, y - uy - ux * 0.5);
}
