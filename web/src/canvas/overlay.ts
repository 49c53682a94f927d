/** Preview of a gesture before it is complete: made by tools, drawn by `scene` and `paint`, never part of the machine. */

import type { ElementKey } from "../model/element.ts";
import type { Edit } from "../model/generated/protocol.ts";
import type { Box, Point } from "../model/geometry.ts";
import { isRefused, type Planned } from "../plan/plan.ts";

/** An edit that is shown as if it were applied. */
export interface ProvisionalEdit {
  readonly edit: Edit;
  /** Paths of the states that the gesture holds. They are drawn above others. */
  readonly held: ReadonlySet<string>;
  /** True if the content of these states is scaled with their boxes. The edit itself contains only the boxes. */
  readonly isScaled: boolean;
}

export interface Overlay {
  readonly provisional: ProvisionalEdit | null;
  /** Lines that show alignment, in the root's coordinates. */
  readonly guides: readonly { readonly from: Point; readonly to: Point }[];
  /** Rubber band, in the root's coordinates. */
  readonly band: Box | null;
  /** Connection that is being drawn, in the root's coordinates; `legal` is null without a target. */
  readonly line: {
    readonly from: Point;
    readonly to: Point;
    /** Waypoints that were set during the gesture. */
    readonly through: readonly Point[];
    readonly data: boolean;
    readonly legal: boolean | null;
  } | null;
  /** Ports and states where the connection may end (true) or may not (false). */
  readonly targets: ReadonlyMap<ElementKey, boolean>;
  /** Container or transition that a drop would go into. */
  readonly drop: ElementKey | null;
  /** Boxes that a drop would create, in the root's coordinates. */
  readonly ghosts: readonly Box[];
  /** Message at the pointer, in CSS pixels of the view: the reason for a refusal, or the result of the gesture. */
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

/** Preview of a plan; empty if the plan is refused. */
export function showing(planned: Planned, held: ReadonlySet<string> = NOTHING_HELD): Overlay {
  if (isRefused(planned)) return NO_OVERLAY;
  return { ...NO_OVERLAY, provisional: { edit: planned.edit, held, isScaled: false } };
}
