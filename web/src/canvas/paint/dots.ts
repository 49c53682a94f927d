/** Ports, waypoints and handles. */

import type { DotMark } from "../scene/list.ts";
import type { PaintContext } from "./ink.ts";

export function paintDot(
  context: PaintContext,
  dot: DotMark,
  fill: string | null,
  stroke: string | null,
): void {
  context.beginPath();
  trace(context, dot, dot.size / 2);
  if (fill !== null) {
    context.fillStyle = fill;
    context.fill();
  }
  if (stroke === null) return;
  context.strokeStyle = stroke;
  context.lineWidth = 2;
  context.beginPath();
  trace(context, dot, dot.size / 2 + 1);
  context.stroke();
}

function trace(context: PaintContext, { shape, x, y, toX, toY }: DotMark, half: number): void {
  switch (shape) {
    case "income":
    case "outcome":
      arrow(context, x, y, toX, toY, half);
      break;
    case "data":
      context.arc(x, y, half * 0.85, 0, 2 * Math.PI);
      break;
    case "scoped":
    case "handle":
      context.rect(x - half * 0.9, y - half * 0.9, half * 1.8, half * 1.8);
      break;
    case "waypoint":
    case "start":
    case "breakpoint":
      context.arc(x, y, half, 0, 2 * Math.PI);
  }
}

/** Triangle on the border that points in the direction of the port. */
function arrow(
  context: PaintContext,
  x: number,
  y: number,
  toX: number,
  toY: number,
  half: number,
): void {
  context.moveTo(x - toX * half * 0.7 - toY * half, y - toY * half * 0.7 + toX * half);
  context.lineTo(x + toX * half, y + toY * half);
  context.lineTo(x - toX * half * 0.7 + toY * half, y - toY * half * 0.7 - toX * half);
  context.closePath();
}
