/** Where the breakpoint of a state is, and is set by a click: on its upper border, near the left corner. */

import type { Box, Point } from "../model/geometry.ts";

/** Smaller boxes, in CSS pixels of their shorter side, have none. */
const LEAST = 24;
/** From the corner, so that the handle for resizing stays free. */
const AWAY = 16;

/** How near to it counts, in CSS pixels. */
export const BREAKPOINT_REACH = 7;

/** The middle of the spot of a box on the screen; null where there is no room for it. */
export function breakpointSpot({ x, y, width, height }: Box): Point | null {
  if (Math.min(width, height) < LEAST) return null;
  return { x: x + Math.min(AWAY, width / 3), y };
}
