/** Levels of detail of a state by its size on the screen. No other file defines them. */

import type { Size } from "../../model/geometry.ts";

/** Smallest sizes that show a detail, in CSS pixels. */
export const DETAIL = {
  /** A box; smaller states are specks. */
  box: 6,
  /** Name and badges. */
  name: 24,
  /** Ports as dots. */
  ports: 72,
  /** Large enough children, with the transitions between them. Smaller containers show a texture. */
  content: 120,
  /** Lines between the children. Between smaller ones they would be a tangle. */
  tangle: 11,
  /** Labels of connections, by the size of the state at their start. */
  lines: 54,
  /** Names of ports and outcomes. */
  labels: 240,
} as const;

/** Smallest size of a speck, in CSS pixels. */
export const SPECK = 1.2;

/** Font sizes on the canvas, in CSS pixels. */
export const TEXT = { small: 11, usual: 12.5, large: 15 } as const;

/** Effective size of a state: the shorter side, or somewhat more for long states. */
export function extent({ width, height }: Size): number {
  return Math.min(Math.sqrt(width * height), 2.5 * Math.min(width, height));
}

/** Opacity from 0.6 at `from` to 1 at a slightly larger size, so that the detail is always readable. */
export function fade(size: number, from: number): number {
  if (size < from) return 0;
  return Math.min(1, 0.6 + (size - from) / (from * 0.15));
}
