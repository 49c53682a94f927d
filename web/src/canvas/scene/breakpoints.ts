/** Breakpoints on the canvas: a dot on the border, hollow if it is disabled. A pale dot on a hovered state shows where a click
 * sets one. */

import { breakpointSpot } from "../layout/breakpoint_spot.ts";
import type { SceneBuilder, SceneNode } from "./builder.ts";
import { groundInk } from "./ring.ts";

const SIZE = 11;

export function breakpointMarks(builder: SceneBuilder, node: SceneNode): void {
  const { input } = builder;
  const { path, key } = node.at;
  const point = input.breakpoints.get(path);
  const isHovered = input.hovered?.kind === "state" && input.hovered.path === path;
  const at = point || isHovered ? breakpointSpot(node) : null;
  if (!at) return;
  builder.layer(node.depth + 1).dots.push({
    what: `${key} breakpoint ${point ?? "none"}`,
    shape: "breakpoint",
    ...at,
    size: SIZE,
    toX: 0,
    toY: 0,
    fill: point === "on" ? "breakpoint" : groundInk(node),
    stroke: point === "on" ? "ground" : "breakpoint",
    alpha: point ? 1 : 0.55,
  });
}
