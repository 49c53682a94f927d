/** Where everything of a machine is, in the root's coordinates: what `scene`, hit test and tools go by. */

import type { Box, Point } from "../model/geometry.ts";
import type { PortPlace } from "../model/layout_reader.ts";

/** A connection as it is drawn. */
export interface Route {
  readonly kind: "transition" | "data_flow";
  /** The container's path. */
  readonly path: string;
  readonly id: number;
  /** Corners from the source to the target, in the root's coordinates. */
  readonly points: readonly Point[];
  /** Which of the corners are waypoints of the author. */
  readonly waypoints: readonly number[];
}

export interface Layout {
  /** The box of a state; undefined if there is none, or if it stands in content that is not shown. */
  readonly box: (path: string) => Box | undefined;
  /** So many units of the root is one of the coordinates inside the state: 1 but in libraries, whose content is scaled to fit. */
  readonly unit: (path: string) => number;
  /** States that show inside the state; none in a library whose content is hidden. */
  readonly children: (path: string) => readonly string[];
  /** Ports on the border; `at` in the root's coordinates. */
  readonly ports: (path: string) => readonly PortPlace[];
  /** Where the name stands. */
  readonly name: (path: string) => Box | undefined;
  /** Connections between the children of a container, and with its own ports. */
  readonly routes: (path: string) => readonly Route[];
}
