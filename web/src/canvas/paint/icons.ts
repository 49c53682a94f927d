/** Small icons made of a few strokes: kinds and conditions of states. */

import type { Icon, IconMark } from "../scene/list.ts";
import type { PaintContext } from "./ink.ts";

/** Shape in a square from -1 to 1. `fill` has areas and `stroke` has lines, each as a list of alternating x and y. */
interface Sign {
  readonly fill?: readonly (readonly number[])[];
  readonly stroke?: readonly (readonly number[])[];
  /** True for a circle around the icon. */
  readonly ring?: boolean;
}

const CHECK = [-0.45, 0, -0.1, 0.4, 0.5, -0.4];
const CROSS = [
  [-0.4, -0.4, 0.4, 0.4],
  [0.4, -0.4, -0.4, 0.4],
];

const SIGNS: Readonly<Record<Icon, Sign>> = {
  library: {
    stroke: [
      [0, -0.6, 0, 0.85],
      [0, -0.6, -0.9, -0.85, -0.9, 0.6, 0, 0.85, 0.9, 0.6, 0.9, -0.85, 0, -0.6],
    ],
  },
  missing: {
    stroke: [
      [-0.35, -0.3, -0.3, -0.5, 0, -0.6, 0.3, -0.5, 0.35, -0.25, 0.2, 0, 0, 0.15, 0, 0.3],
      [0, 0.55, 0, 0.6],
    ],
    ring: true,
  },
  barrier: {
    stroke: [
      [-0.9, -0.6, 0.5, -0.6],
      [-0.9, 0, 0.5, 0],
      [-0.9, 0.6, 0.5, 0.6],
      [0.75, -0.9, 0.75, 0.9],
    ],
  },
  preemptive: {
    stroke: [
      [-0.9, -0.6, 0, -0.6],
      [-0.9, 0, 0.9, 0],
      [-0.9, 0.6, 0, 0.6],
      [0.4, -0.45, 0.9, 0, 0.4, 0.45],
    ],
  },
  decider: { stroke: [[0, -0.9, 0.9, 0, 0, 0.9, -0.9, 0, 0, -0.9]] },
  error: {
    stroke: [
      [0, -0.55, 0, 0.15],
      [0, 0.5, 0, 0.55],
    ],
    ring: true,
  },
  warning: {
    stroke: [
      [0, -0.9, 1, 0.85, -1, 0.85, 0, -0.9],
      [0, -0.25, 0, 0.25],
      [0, 0.55, 0, 0.6],
    ],
  },
  start: { fill: [[-0.6, -0.8, 0.8, 0, -0.6, 0.8]] },
  running: { fill: [[-0.6, -0.8, 0.8, 0, -0.6, 0.8]] },
  waiting: {
    fill: [
      [-0.55, 0.85, 0.55, 0.85, 0, 0.2],
      [-0.35, -0.45, 0.35, -0.45, 0, 0],
    ],
    stroke: [
      [-0.75, -0.95, 0.75, -0.95],
      [-0.75, 0.95, 0.75, 0.95],
      [-0.55, -0.95, -0.55, -0.55, 0, 0, -0.55, 0.55, -0.55, 0.95],
      [0.55, -0.95, 0.55, -0.55, 0, 0, 0.55, 0.55, 0.55, 0.95],
    ],
  },
  held: {
    fill: [
      [-0.6, -0.7, -0.15, -0.7, -0.15, 0.7, -0.6, 0.7],
      [0.15, -0.7, 0.6, -0.7, 0.6, 0.7, 0.15, 0.7],
    ],
  },
  next: {
    stroke: [
      [-0.7, -0.6, -0.1, 0, -0.7, 0.6],
      [0.6, -0.7, 0.6, 0.7],
    ],
  },
  failed: { stroke: CROSS, ring: true },
  preempted: {
    stroke: [
      [-0.7, -0.6, -0.1, 0, -0.7, 0.6],
      [0.1, -0.6, 0.7, 0, 0.1, 0.6],
    ],
  },
  added: {
    stroke: [
      [-0.7, 0, 0.7, 0],
      [0, -0.7, 0, 0.7],
    ],
  },
  removed: { stroke: [[-0.7, 0, 0.7, 0]] },
  changed: { stroke: [CHECK] },
};

export function paintIcon(context: PaintContext, mark: IconMark, colour: string): void {
  const sign = SIGNS[mark.icon];
  const half = mark.size / 2;
  context.globalAlpha = mark.alpha;
  context.fillStyle = colour;
  context.strokeStyle = colour;
  context.lineWidth = 1.4;
  context.beginPath();
  for (const outline of sign.fill ?? []) trace(context, outline, mark, half * 0.9);
  context.fill();
  context.beginPath();
  if (sign.ring) context.arc(mark.x, mark.y, half * 0.95, 0, 2 * Math.PI);
  for (const outline of sign.stroke ?? []) trace(context, outline, mark, half * 0.9);
  context.stroke();
}

function trace(
  context: PaintContext,
  outline: readonly number[],
  { x, y }: IconMark,
  half: number,
): void {
  for (let at = 0; at + 1 < outline.length; at += 2) {
    const [toX, toY] = [x + (outline[at] ?? 0) * half, y + (outline[at + 1] ?? 0) * half];
    if (at === 0) context.moveTo(toX, toY);
    else context.lineTo(toX, toY);
  }
}
