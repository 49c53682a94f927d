/** Outline of a state, shared by all marks on it: its corners, rings around it, and its background. */

import { readLayout } from "../../model/layout_reader.ts";
import { type SceneNode, shade } from "./builder.ts";
import type { BoxMark, Ink } from "./list.ts";

/** Corner radius of a state of this size. */
export function radiusOf(node: SceneNode): number {
  return Math.min(7, node.extent * 0.09);
}

/** Background of a state and of the plates on it. */
export function groundInk({ at, depth }: SceneNode): Ink {
  if (at.state.kind === "library") return readLayout(at.state).background ?? "library-ground";
  return readLayout(at.state).background ?? shade(depth);
}

/** Ring at this distance around a state. */
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
