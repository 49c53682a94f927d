/** What can be hit, and how the machine is looked at meanwhile. */

import type { ElementRef } from "../../model/element.ts";
import type { Point, Size } from "../../model/geometry.ts";
import type { ViewModes } from "../../store/page/view.ts";

/** A side or corner of a box, as compasses and cursors name it. */
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
  /** Where a selected state is taken to be resized. */
  | { readonly on: "grip"; readonly element: StateRef; readonly grip: Grip }
  | { readonly on: "port"; readonly element: CanvasPort; readonly at: Point }
  /** The end of a selected connection. */
  | { readonly on: "end"; readonly element: LineRef; readonly end: "from" | "to" }
  /** A waypoint of a connection, by its number. */
  | { readonly on: "waypoint"; readonly element: LineRef; readonly index: number }
  /** The middle of a part of a connection: a waypoint made there gets this number. */
  | { readonly on: "middle"; readonly element: LineRef; readonly index: number }
  | { readonly on: "line"; readonly element: LineRef }
  /** Where a click sets a breakpoint of the state, or takes it away. */
  | { readonly on: "breakpoint"; readonly element: StateRef }
  /** The name of a state; of a selected one also the corner by which its box is resized. */
  | { readonly on: "name"; readonly element: StateRef; readonly corner: boolean }
  | { readonly on: "state"; readonly element: StateRef };

/** How the machine is looked at. */
export interface CanvasLook {
  readonly selection: ReadonlySet<string>;
  readonly hovered: ElementRef | null;
  readonly modes: ViewModes;
  /** Of the view, in CSS pixels. */
  readonly size: Size;
}
