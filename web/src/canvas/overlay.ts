/** What a gesture shows before it is done: made by tools, drawn by `scene` and `paint`, never part of the machine. */

import type { ElementKey } from "../model/element.ts";
import type { Box, Point } from "../model/geometry.ts";

export interface Overlay {
  /** States where the gesture has them, by path, in the coordinates of their container. */
  readonly boxes: ReadonlyMap<string, Box>;
  /** Containers whose content is scaled along with the box, while they are resized so. */
  readonly scaled: ReadonlySet<string>;
  /** Names where the gesture has them, by path, in the coordinates of their state. */
  readonly names: ReadonlyMap<string, Box>;
  /** Ports where the gesture has them, in the coordinates of their state. */
  readonly ports: ReadonlyMap<ElementKey, Point>;
  /** Waypoints of connections, in the coordinates of the container. */
  readonly waypoints: ReadonlyMap<ElementKey, readonly Point[]>;
  /** Lines that say what lines up, in the root's coordinates. */
  readonly guides: readonly { readonly from: Point; readonly to: Point }[];
  /** The rubber band, in the root's coordinates. */
  readonly band: Box | null;
  /** The connection that is being drawn, in the root's coordinates; `legal` is null over nothing. */
  readonly line: {
    readonly from: Point;
    readonly to: Point;
    /** Waypoints that were set on the way. */
    readonly through: readonly Point[];
    readonly data: boolean;
    readonly legal: boolean | null;
  } | null;
  /** Ports and states where the connection may end (true) or may not (false). */
  readonly targets: ReadonlyMap<ElementKey, boolean>;
  /** The container or transition into which something would be dropped. */
  readonly drop: ElementKey | null;
  /** What comes when it is dropped: new boxes in the root's coordinates. */
  readonly ghosts: readonly Box[];
  /** Said at the pointer, in CSS pixels of the view: why not, or what will be. */
  readonly message: { readonly at: Point; readonly text: string; readonly bad: boolean } | null;
}

export const NO_OVERLAY: Overlay = {
  boxes: new Map(),
  scaled: new Set(),
  names: new Map(),
  ports: new Map(),
  waypoints: new Map(),
  guides: [],
  band: null,
  line: null,
  targets: new Map(),
  drop: null,
  ghosts: [],
  message: null,
};
