/** Moves and zooms the view: by dragging, with two fingers, by the wheel. */

import { distance, type Point } from "../../model/geometry.ts";
import type { Camera } from "../../store/page/view.ts";
import { panned, zoomedAt } from "../camera.ts";
import { NO_OVERLAY } from "../overlay.ts";
import { type Gesture, minus, NOTHING, type Pointer } from "./gesture.ts";

/** Begins to drag what is shown. */
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

/** The camera after two fingers went from here to there: what was under them still is. */
export function pinched(camera: Camera, from: Fingers, to: Fingers): Camera {
  const before = distance(from[0], from[1]);
  const factor = before > 0 ? distance(to[0], to[1]) / before : 1;
  const [start, end] = [middle(from), middle(to)];
  return zoomedAt(panned(camera, minus(end, start)), end, factor || 1);
}

function middle([one, other]: Fingers): Point {
  return { x: (one.x + other.x) / 2, y: (one.y + other.y) / 2 };
}

/** What a turn of the wheel says. */
export interface Wheel {
  readonly deltaX: number;
  readonly deltaY: number;
  /** 0: pixels, 1: lines, 2: pages. */
  readonly deltaMode: number;
  readonly ctrl: boolean;
  readonly shift: boolean;
}

/** The camera after the wheel was turned at a point. Two fingers on a touch pad pan, whatever the wheel does; Ctrl and
 * pinching, which browsers tell as Ctrl, zoom. */
export function wheeled(camera: Camera, at: Point, wheel: Wheel, setting: "zoom" | "pan"): Camera {
  if (wheel.ctrl) return zoomedAt(camera, at, zoomFactor(wheel));
  const isZoom = setting === "zoom" && !wheel.shift && !isTouchPad(wheel);
  return isZoom ? zoomedAt(camera, at, zoomFactor(wheel)) : panned(camera, scrolled(wheel));
}

/** Mice turn by whole steps and along one axis. */
function isTouchPad({ deltaX, deltaY, deltaMode }: Wheel): boolean {
  if (deltaMode !== 0) return false;
  return deltaX !== 0 || Math.abs(deltaY) < 40 || !Number.isInteger(deltaY);
}

const LINE = 40;
const PAGE = 400;

function pixels(delta: number, mode: number): number {
  return delta * (mode === 1 ? LINE : mode === 2 ? PAGE : 1);
}

/** One step of a mouse (100 to 120) is a fifth nearer; a touch pad's small steps are as even. */
function zoomFactor({ deltaY, deltaMode, ctrl }: Wheel): number {
  const turned = Math.max(-300, Math.min(300, pixels(deltaY, deltaMode)));
  const isPinch = ctrl && deltaMode === 0 && Math.abs(deltaY) < 40;
  return Math.exp(-turned * (isPinch ? 0.01 : 0.0018));
}

function scrolled({ deltaX, deltaY, deltaMode, shift }: Wheel): Point {
  const [x, y] = shift && deltaX === 0 ? [deltaY, 0] : [deltaX, deltaY];
  return { x: -pixels(x, deltaMode), y: -pixels(y, deltaMode) };
}
