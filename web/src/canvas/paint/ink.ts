/** Definitions shared by all painters. */

import type { Colours } from "./colours.ts";

export type PaintContext = CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D;

/** Colour of a named ink. An ink without a name is a colour itself. */
export function inkOf(colours: Colours, ink: string): string {
  return colours[ink] ?? ink;
}
