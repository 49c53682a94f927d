/** How much of a state is drawn, by its size on the screen: the one table that says so. */

import type { Size } from "../../model/geometry.ts";

/** From this size on, in CSS pixels. */
export const DETAIL = {
  /** A box of its own; smaller ones are specks. */
  box: 6,
  /** Its name, and what is worth a badge. */
  name: 24,
  /** Ports as dots. */
  ports: 72,
  /** What stands inside, as far as that is large enough itself, with transitions between. Before, that is a texture. */
  content: 120,
  /** Lines between smaller states would be a tangle. */
  tangle: 11,
  /** Labels of connections, by the size of the state that they come from. */
  lines: 54,
  /** Names of ports and outcomes. */
  labels: 240,
} as const;

/** A speck is drawn from this size on. */
export const SPECK = 1.2;

/** Text on the screen has one of these sizes. */
export const TEXT = { small: 11, usual: 12.5, large: 15 } as const;

/** The size that counts: the shorter side, for long states somewhat more. */
export function extent({ width, height }: Size): number {
  return Math.min(Math.sqrt(width * height), 2.5 * Math.min(width, height));
}

/** From the better half at `from` to all of it a little later: what is there can be read. */
export function fade(size: number, from: number): number {
  if (size < from) return 0;
  return Math.min(1, 0.6 + (size - from) / (from * 0.15));
}
