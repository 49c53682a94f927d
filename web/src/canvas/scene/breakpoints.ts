/** Breakpoints on the canvas: a dot on the border, hollow if it is off; a pale one under the pointer says where to click. */

import { breakpointSpot } from "../breakpoint_spot.ts";
import type { Drawing, Spot } from "./drawing.ts";
import { groundInk } from "./ring.ts";

const SIZE = 11;

export function breakpointMarks(drawing: Drawing, spot: Spot): void {
  const { input } = drawing;
  const { path, key } = spot.at;
  const point = input.breakpoints.get(path);
  const isHovered = input.hovered?.kind === "state" && input.hovered.path === path;
  const at = point || isHovered ? breakpointSpot(spot) : null;
  if (!at) return;
  drawing.layer(spot.depth + 1).dots.push({
    what: `${key} breakpoint ${point ?? "none"}`,
    shape: "breakpoint",
    ...at,
    size: SIZE,
    toX: 0,
    toY: 0,
    fill: point === "on" ? "breakpoint" : groundInk(spot),
    stroke: point === "on" ? "ground" : "breakpoint",
    alpha: point ? 1 : 0.55,
  });
}
