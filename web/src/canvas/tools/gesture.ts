/** What all gestures have in common. A gesture is a value: each movement of the pointer gives the next one, which shows what
 * would come of it and knows what comes when the button is released. Nothing here touches a document or a store. */

import type { ElementRef } from "../../model/element.ts";
import type { Point, Size } from "../../model/geometry.ts";
import type { Machine } from "../../model/machine.ts";
import type { Planned } from "../../plan/plan.ts";
import type { Camera } from "../../store/page/view.ts";
import { worldFromScreen } from "../camera.ts";
import type { CanvasLook } from "../hit/look.ts";
import type { Layout } from "../layout.ts";
import type { LayoutTree } from "../layout_tree.ts";
import type { Overlay } from "../overlay.ts";

/** Where the pointer is, in CSS pixels of the view, and which keys are held with it. */
export interface Pointer extends Point {
  readonly shift: boolean;
  /** Ctrl, or the command key of a Mac. */
  readonly ctrl: boolean;
  readonly alt: boolean;
}

/** What a gesture can see: the machine as it is without the gesture. */
export interface ToolContext {
  readonly machine: Machine;
  readonly layout: LayoutTree;
  readonly camera: Camera;
  readonly size: Size;
  readonly look: CanvasLook;
}

/** What comes of a gesture. */
export interface GestureResult {
  readonly plan?: Planned;
  /** Selects these and nothing else. */
  readonly select?: readonly ElementRef[];
  readonly toggle?: ElementRef;
  /** A command, by its id. */
  readonly run?: { readonly command: string; readonly argument?: unknown };
}

export const NOTHING: GestureResult = {};

export interface Gesture {
  /** "move", "connect", …: for tests and for those who look. */
  readonly name: string;
  /** As CSS names it. */
  readonly cursor: string;
  readonly overlay: Overlay;
  /** The camera that the gesture wants, if it moves that. */
  readonly camera?: Camera;
  /** What is selected as soon as it begins. */
  readonly select?: readonly ElementRef[];
  /** Whether it goes on without a button held, until a click on its target. */
  readonly isSticky?: boolean;
  readonly move: (pointer: Pointer, context: ToolContext) => Gesture;
  /** What comes of it now. */
  readonly result: () => GestureResult;
  /** A press while it goes on without a button, or a key; null if it has no use for it. */
  readonly mark?: (context: ToolContext) => Gesture | null;
  /** The next (1) or last (-1) target by keyboard. */
  readonly cycle?: (by: 1 | -1, context: ToolContext) => Gesture;
}

/** How far a pointer, or a finger, goes before it drags, in CSS pixels. */
export const DRAG_DISTANCE = { pointer: 4, finger: 10 } as const;

/** The pointer in the root's coordinates. */
export function worldOf(pointer: Point, context: ToolContext): Point {
  return worldFromScreen(context.camera, pointer);
}

/** A point of the root's coordinates in those inside a state. */
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

/** The innermost state that belongs to the machine itself: the path, or the library state around it. */
export function ownState(machine: Machine, path: string): string {
  let own = path;
  while (machine.isInLibrary(own)) {
    const end = own.lastIndexOf("/");
    if (end < 0) return own;
    own = own.slice(0, end);
  }
  return own;
}
