/** What others may ask of the canvas: where to look. What it shows it reads from the stores by itself. */

import type { ReadonlySignal } from "@preact/signals-core";
import type { ElementRef } from "../model/element.ts";
import type { Box, Point } from "../model/geometry.ts";

export interface CanvasControl {
  /** Flies so that these states (or, of none, the root) fill the view. */
  readonly fit: (paths: readonly string[]) => void;
  /** Flies so far that the element can be seen and read, and no farther. */
  readonly reveal: (element: ElementRef) => void;
  /** Flies to the machine that is offered, or to one of its states. */
  readonly revealGhost: (path?: string) => void;
  /** Zooms about the middle of the view. */
  readonly zoom: (factor: number) => void;
  /** Moves what is shown by so many CSS pixels. */
  readonly pan: (by: Point) => void;
  /** The view in the root's coordinates. */
  readonly visible: () => Box;
  /** Where in a container the pointer is, in the container's coordinates; null if it is not over the canvas. */
  readonly pointer: () => { readonly path: string; readonly at: Point } | null;
  /** Begins a connection at the selected port, or at the next best one of the selected state, by keyboard. */
  readonly beginConnection: () => void;
  /** Begins to rename the state, in place. */
  readonly rename: (path: string) => void;
  /** Ends what the pointer or keyboard has begun, without a change; false if nothing was. */
  readonly cancel: () => boolean;
  /** Opens the menu of what is selected, at its place. */
  readonly openMenu: () => void;
  /** Makes what is still to be made of steps by keyboard: before anything else is done. */
  readonly flush: () => void;
  readonly focus: () => void;
  /** The state that fills the view: what one works in. */
  readonly stage: ReadonlySignal<string>;
}
