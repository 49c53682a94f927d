/** Moves and zooms the view: by dragging, with two fingers, or by the wheel. */

import { distance, type Point } from "../../model/geometry.ts";
import type { Camera } from "../../store/page/view.ts";
import { panned, zoomedAt } from "../camera/camera.ts";
import { NO_OVERLAY } from "../overlay.ts";
import { type Gesture, minus, NOTHING, type Pointer } from "./gesture.ts";

/** Starts to drag the view. */
export function panning(pressed: Pointer, camera: Camera): Gesture {
  return {
    name: "pan",
    cursor: "grabbing",
    overlay: NO_OVERLAY,
    camera,
    move: (pointer) => panning(pointer, panned(camera, minus(pointer, pressed))),
    result: () => NOTHING,
  };
}

export type Fingers = readonly [Point, Point];

/** Camera after a movement of two fingers. The points under the fingers stay under them. */
export function pinched(camera: Camera, from: Fingers, to: Fingers): Camera {
  const before = distance(from[0], from[1]);
  const factor = before > 0 ? distance(to[0], to[1]) / before : 1;
  const [start, end] = [middle(from), middle(to)];
  return zoomedAt(panned(camera, minus(end, start)), end, factor || 1);
}

function middle([one, other]: Fingers): Point {
  return { x: (one.x + other.x) / 2, y: (one.y + other.y) / 2 };
}

/** Data of a wheel event. */
export interface Wheel {
  readonly deltaX: number;
  readonly deltaY: number;
  /** Unit of the deltas: 0 for pixels, 1 for lines, 2 for pages. */
  readonly deltaMode: number;
  readonly ctrl: boolean;
  readonly shift: boolean;
}

/** Camera after a wheel event at a point. Two fingers on a touch pad pan, whatever the setting. Ctrl zooms, and so does pinching,
 * which browsers report as Ctrl. */
export function wheeled(camera: Camera, at: Point, wheel: Wheel, setting: "zoom" | "pan"): Camera {
  if (wheel.ctrl) return zoomedAt(camera, at, zoomFactor(wheel));
  const isZoom = setting === "zoom" && !wheel.shift && !isTouchPad(wheel);
  return isZoom ? zoomedAt(camera, at, zoomFactor(wheel)) : panned(camera, scrolled(wheel));
}

/** A mouse wheel turns by whole steps and along one axis. */
function isTouchPad({ deltaX, deltaY, deltaMode }: Wheel): boolean {
  if (deltaMode !== 0) return false;
  return deltaX !== 0 || Math.abs(deltaY) < 40 || !Number.isInteger(deltaY);
}

const LINE = 40;
const PAGE = 400;

function pixels(delta: number, mode: number): number {
  return delta * (mode === 1 ? LINE : mode === 2 ? PAGE : 1);
}

/** Zoom factor: one step of a mouse wheel (100 to 120) zooms by a fifth; the small steps of a touch pad zoom in proportion. */
function zoomFactor({ deltaY, deltaMode, ctrl }: Wheel): number {
  const turned = Math.max(-300, Math.min(300, pixels(deltaY, deltaMode)));
  const isPinch = ctrl && deltaMode === 0 && Math.abs(deltaY) < 40;
  return Math.exp(-turned * (isPinch ? 0.01 : 0.0018));
}

function scrolled({ deltaX, deltaY, deltaMode, shift }: Wheel): Point {
  const [x, y] = shift && deltaX === 0 ? [deltaY, 0] : [deltaX, deltaY];
  return { x: -pixels(x, deltaMode), y: -pixels(y, deltaMode) };
}
