/** Interface for moving and controlling the canvas from outside. The canvas reads its content from the stores. */

import type { ReadonlySignal } from "@preact/signals-core";
import type { ElementRef } from "../model/element.ts";
import type { Box, Point } from "../model/geometry.ts";

export interface CanvasControl {
  /** Flies until these states fill the view. An empty list means the root. */
  readonly fit: (paths: readonly string[]) => void;
  /** Flies until the element is visible and readable, and no farther. */
  readonly reveal: (element: ElementRef) => void;
  /** Flies to the proposed machine, or to one of its states. */
  readonly revealGhost: (path?: string) => void;
  /** Zooms about the centre of the view. */
  readonly zoom: (factor: number) => void;
  /** Moves the content by this many CSS pixels. */
  readonly pan: (by: Point) => void;
  /** Visible area, in the root's coordinates. */
  readonly visible: () => Box;
  /** Container under the pointer, and the position in its coordinates; null if the pointer is not over the canvas. */
  readonly pointer: () => { readonly path: string; readonly at: Point } | null;
  /** Starts a connection by keyboard: at the selected port, or at the most suitable port of the selected state. */
  readonly beginConnection: () => void;
  /** Opens the field that renames the state in place. */
  readonly rename: (path: string) => void;
  /** Cancels the current gesture; false if there was none. */
  readonly cancel: () => boolean;
  /** Opens the menu of the selection, at its position. */
  readonly openMenu: () => void;
  /** Applies pending steps by keyboard. Call it before other changes. */
  readonly flush: () => void;
  readonly focus: () => void;
  /** The innermost state that fills the view. The user works in it. */
  readonly workingContainer: ReadonlySignal<string>;
}
