/** What a gesture shows before it is done: made by tools, drawn by `scene` and `paint`, never part of the machine. */

import type { ElementKey } from "../model/element.ts";
import type { Edit } from "../model/generated/protocol.ts";
import type { Box, Point } from "../model/geometry.ts";
import { isRefused, type Planned } from "../plan/plan.ts";

/** An edit that shows as if it were made. */
export interface ProvisionalEdit {
  readonly edit: Edit;
  /** States that the gesture has in its hand, by path: they show above others. */
  readonly held: ReadonlySet<string>;
  /** Whether what lies inside of them grows along with their boxes, which is all that the edit says of it. */
  readonly isScaled: boolean;
}

export interface Overlay {
  readonly provisional: ProvisionalEdit | null;
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
  provisional: null,
  guides: [],
  band: null,
  line: null,
  targets: new Map(),
  drop: null,
  ghosts: [],
  message: null,
};

const NOTHING_HELD: ReadonlySet<string> = new Set();

/** Shows what a plan would do; nothing if it is refused. */
export function showing(planned: Planned, held: ReadonlySet<string> = NOTHING_HELD): Overlay {
  if (isRefused(planned)) return NO_OVERLAY;
  return { ...NO_OVERLAY, provisional: { edit: planned.edit, held, isScaled: false } };
}
