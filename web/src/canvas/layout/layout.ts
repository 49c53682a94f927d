/** Positions of all elements of a machine, in the root's coordinates. `scene`, the hit test and the tools use them. */

import type { Box, Point } from "../../model/geometry.ts";
import type { PortPlace } from "../../model/layout_reader.ts";

/** A connection as drawn on the canvas. */
export interface Route {
  readonly kind: "transition" | "data_flow";
  /** Path of the container. */
  readonly path: string;
  readonly id: number;
  /** Corners from the source to the target, in the root's coordinates. */
  readonly points: readonly Point[];
  /** Indices of the corners that are waypoints of the author. */
  readonly waypoints: readonly number[];
}

export interface Layout {
  /** Box of a state; undefined if the state does not exist or is inside hidden content. */
  readonly box: (path: string) => Box | undefined;
  /** Units of the root per unit inside the state. It is 1 outside libraries, whose content is scaled to fit. */
  readonly unit: (path: string) => number;
  /** Visible children of the state. A library with hidden content has none. */
  readonly children: (path: string) => readonly string[];
  /** Ports on the border; `at` is in the root's coordinates. */
  readonly ports: (path: string) => readonly PortPlace[];
  /** Box of the name. */
  readonly name: (path: string) => Box | undefined;
  /** Connections between the children of a container, and with its own ports. */
  readonly routes: (path: string) => readonly Route[];
}
