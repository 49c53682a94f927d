/** Position of the dot that shows and toggles a breakpoint: on the upper border of a state, near its left corner. */

import type { Box, Point } from "../../model/geometry.ts";

/** Smallest shorter side of a box that has a dot, in CSS pixels. */
const LEAST = 24;
/** Distance from the corner, in CSS pixels. It keeps the resize handle free. */
const AWAY = 16;

/** Largest distance from the dot at which a click still hits it, in CSS pixels. */
export const BREAKPOINT_REACH = 7;

/** Centre of the dot of a box on the screen; null if the box is too small for one. */
export function breakpointSpot({ x, y, width, height }: Box): Point | null {
  if (Math.min(width, height) < LEAST) return null;
  return { x: x + Math.min(AWAY, width / 3), y };
}
