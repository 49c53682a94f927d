/** Result of the hit test, and the state of the view that it depends on. */

import type { ElementRef } from "../../model/element.ts";
import type { Point, Size } from "../../model/geometry.ts";
import type { ViewModes } from "../../store/page/view.ts";

/** Side or corner of a box, named by compass direction. */
export type Grip = "n" | "ne" | "e" | "se" | "s" | "sw" | "w" | "nw";

export interface StateRef {
  readonly kind: "state";
  readonly path: string;
}

export interface LineRef {
  readonly kind: "transition" | "data_flow";
  readonly path: string;
  readonly id: number;
}

export type CanvasPort =
  | { readonly kind: "income"; readonly path: string }
  | {
      readonly kind: "outcome" | "input" | "output" | "scoped_variable";
      readonly path: string;
      readonly id: number;
    };

export type CanvasHit =
  /** Side or corner that resizes a selected state. */
  | { readonly on: "grip"; readonly element: StateRef; readonly grip: Grip }
  | { readonly on: "port"; readonly element: CanvasPort; readonly at: Point }
  /** End of a selected connection. */
  | { readonly on: "end"; readonly element: LineRef; readonly end: "from" | "to" }
  /** Waypoint of a connection, by its index. */
  | { readonly on: "waypoint"; readonly element: LineRef; readonly index: number }
  /** Middle of a part of a connection. `index` is that of a waypoint added here. */
  | { readonly on: "middle"; readonly element: LineRef; readonly index: number }
  | { readonly on: "line"; readonly element: LineRef }
  /** Dot that toggles the breakpoint of the state. */
  | { readonly on: "breakpoint"; readonly element: StateRef }
  /** Name of a state. `corner` marks the corner that resizes the box of a selected state's name. */
  | { readonly on: "name"; readonly element: StateRef; readonly corner: boolean }
  | { readonly on: "state"; readonly element: StateRef };

/** State of the view that affects visibility. */
export interface CanvasLook {
  readonly selection: ReadonlySet<string>;
  readonly hovered: ElementRef | null;
  readonly modes: ViewModes;
  /** Size of the view, in CSS pixels. */
  readonly size: Size;
}
