/** The outline of a state as the things drawn on it share it: its corners, rings around it, and what it is filled with. */

import { layoutOf } from "../../model/drawing.ts";
import { type Spot, shade } from "./drawing.ts";
import type { BoxMark, Ink } from "./list.ts";

/** The corner radius of a state of this size. */
export function radiusOf(spot: Spot): number {
  return Math.min(7, spot.extent * 0.09);
}

/** What a state is filled with, and what stands behind texts upon it. */
export function groundInk({ at, depth }: Spot): Ink {
  if (at.state.kind === "library") return layoutOf(at.state).background ?? "library-ground";
  return layoutOf(at.state).background ?? shade(depth);
}

/** A ring so far around a state. */
export function ring(spot: Spot, ink: string, line: number, away: number, what: string): BoxMark {
  return {
    what: `${what} ${ink}`,
    x: spot.x - away,
    y: spot.y - away,
    width: spot.width + 2 * away,
    height: spot.height + 2 * away,
    radius: radiusOf(spot) + away,
    fill: null,
    stroke: ink,
    line,
    dash: false,
    alpha: 1,
  };
}
