/** The outline of a state as the things drawn on it share it: its corners, rings around it, and what it is filled with. */

import { readLayout } from "../../model/layout_reader.ts";
import { type SceneNode, shade } from "./builder.ts";
import type { BoxMark, Ink } from "./list.ts";

/** The corner radius of a state of this size. */
export function radiusOf(node: SceneNode): number {
  return Math.min(7, node.extent * 0.09);
}

/** What a state is filled with, and what stands behind texts upon it. */
export function groundInk({ at, depth }: SceneNode): Ink {
  if (at.state.kind === "library") return readLayout(at.state).background ?? "library-ground";
  return readLayout(at.state).background ?? shade(depth);
}

/** A ring so far around a state. */
export function ring(
  node: SceneNode,
  ink: string,
  line: number,
  away: number,
  what: string,
): BoxMark {
  return {
    what: `${what} ${ink}`,
    x: node.x - away,
    y: node.y - away,
    width: node.width + 2 * away,
    height: node.height + 2 * away,
    radius: radiusOf(node) + away,
    fill: null,
    stroke: ink,
    line,
    dash: false,
    alpha: 1,
  };
}
