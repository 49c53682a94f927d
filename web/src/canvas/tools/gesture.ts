/** Definitions shared by all gestures. A gesture is an immutable value: each movement of the pointer returns the next one, with a
 * preview and the result of a release. Nothing here accesses a document or a store. */

import type { ElementRef } from "../../model/element.ts";
import type { Point, Size } from "../../model/geometry.ts";
import type { Machine } from "../../model/machine.ts";
import type { Planned } from "../../plan/plan.ts";
import type { CommandCall } from "../../store/page/command_arguments.ts";
import type { Camera } from "../../store/page/view.ts";
import { worldFromScreen } from "../camera/camera.ts";
import type { CanvasLook } from "../hit/look.ts";
import type { Layout } from "../layout/layout.ts";
import type { LayoutTree } from "../layout/layout_tree.ts";
import type { Overlay } from "../overlay.ts";

/** Position of the pointer in CSS pixels of the view, and the pressed modifier keys. */
export interface Pointer extends Point {
  readonly shift: boolean;
  /** Ctrl, or the command key of a Mac. */
  readonly ctrl: boolean;
  readonly alt: boolean;
}

/** Input of a gesture: the machine without the effects of the gesture. */
export interface ToolContext {
  readonly machine: Machine;
  readonly layout: LayoutTree;
  readonly camera: Camera;
  readonly size: Size;
  readonly look: CanvasLook;
}

/** Result of a gesture. */
export interface GestureResult {
  readonly plan?: Planned;
  /** Replaces the selection. */
  readonly select?: readonly ElementRef[];
  readonly toggle?: ElementRef;
  /** Command to run, by its id. */
  readonly run?: CommandCall;
}

export const NOTHING: GestureResult = {};

export interface Gesture {
  /** Name such as "move" or "connect", for permission checks and tests. */
  readonly name: string;
  /** Name of a CSS cursor. */
  readonly cursor: string;
  readonly overlay: Overlay;
  /** New camera, if the gesture moves it. */
  readonly camera?: Camera;
  /** Selection at the start of the gesture. */
  readonly select?: readonly ElementRef[];
  /** True if the gesture continues without a pressed button, until a click on its target. */
  readonly isSticky?: boolean;
  readonly move: (pointer: Pointer, context: ToolContext) => Gesture;
  /** Result if the gesture ends now. */
  readonly result: () => GestureResult;
  /** Handles the space key, or a press during a sticky gesture: sets a waypoint. Null if there is nothing to set. */
  readonly mark?: (context: ToolContext) => Gesture | null;
  /** Selects the next (1) or previous (-1) target by keyboard. */
  readonly cycle?: (by: 1 | -1, context: ToolContext) => Gesture;
}

/** Distance in CSS pixels from which a movement of a pointer or finger is a drag. */
export const DRAG_DISTANCE = { pointer: 4, finger: 10 } as const;

/** Converts the pointer's position to the root's coordinates. */
export function worldOf(pointer: Point, context: ToolContext): Point {
  return worldFromScreen(context.camera, pointer);
}

/** Converts a point from the root's coordinates to those inside a state. */
export function inState(layout: Layout, path: string, at: Point): Point {
  const box = layout.box(path);
  const unit = layout.unit(path);
  return box ? { x: (at.x - box.x) / unit, y: (at.y - box.y) / unit } : at;
}

export function plus(one: Point, other: Point): Point {
  return { x: one.x + other.x, y: one.y + other.y };
}

export function minus(one: Point, other: Point): Point {
  return { x: one.x - other.x, y: one.y - other.y };
}

/** Innermost state that belongs to the machine itself: the path, or the library state around it. */
export function ownState(machine: Machine, path: string): string {
  let own = path;
  while (machine.isInLibrary(own)) {
    const end = own.lastIndexOf("/");
    if (end < 0) return own;
    own = own.slice(0, end);
  }
  return own;
}
