/** What all painters share. */

import type { Colours } from "./colours.ts";

export type PaintContext = CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D;

/** The colour of an ink: its name's, or itself. */
export function inkOf(colours: Colours, ink: string): string {
  return colours[ink] ?? ink;
}
