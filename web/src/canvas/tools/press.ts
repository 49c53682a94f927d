/** Press of the button: a click if the pointer stays, otherwise the gesture for the element under it. */

import { type ElementRef, elementOf, keyOf } from "../../model/element.ts";
import { distance } from "../../model/geometry.ts";
import { parentOf } from "../../model/path.ts";
import { routeOf } from "../hit/hit.ts";
import { nearestPart } from "../hit/lines.ts";
import type { CanvasHit } from "../hit/look.ts";
import { NO_OVERLAY } from "../overlay.ts";
import { banding } from "./band.ts";
import { connecting } from "./connect.ts";
import {
  DRAG_DISTANCE,
  type Gesture,
  type GestureResult,
  ownState,
  type Pointer,
  type ToolContext,
} from "./gesture.ts";
import { moving } from "./move.ts";
import { naming } from "./name.ts";
import { panning } from "./pan.ts";
import { sliding } from "./port.ts";
import { reconnecting } from "./reconnect.ts";
import { cursorOf, resizing } from "./resize.ts";
import { bending } from "./waypoint.ts";
import { isStage } from "./working_container.ts";

/** Position and kind of a press. */
export interface Press extends Pointer {
  readonly isTouch: boolean;
}

/** Starts with the element under the pointer. */
export function pressing(hit: CanvasHit | null, press: Press, context: ToolContext): Gesture {
  const least = press.isTouch ? DRAG_DISTANCE.finger : DRAG_DISTANCE.pointer;
  const isFar = (pointer: Pointer) => distance(pointer, press) >= least;
  const still: Gesture = {
    name: "press",
    cursor: cursorAt(hit),
    overlay: NO_OVERLAY,
    move: (pointer, then) =>
      isFar(pointer) ? dragging(hit, press, context).move(pointer, then) : still,
    result: () => clicked(hit, press, context),
  };
  return still;
}

function clicked(hit: CanvasHit | null, press: Press, context: ToolContext): GestureResult {
  if (!hit) return press.ctrl || press.shift ? {} : { select: [] };
  if (setsBreakpoint(hit, press, context)) {
    return { run: { command: "run.breakpoint", argument: hit.element.path } };
  }
  return press.ctrl || press.shift ? { toggle: hit.element } : { select: [hit.element] };
}

/** True if the click toggles a breakpoint. A touch is imprecise, so it must select the state first. */
function setsBreakpoint(hit: CanvasHit, press: Press, context: ToolContext): boolean {
  if (hit.on !== "breakpoint" || press.ctrl || press.shift) return false;
  return !press.isTouch || isSelected(hit.element, context);
}

/** Gesture that a drag starts there. */
function dragging(hit: CanvasHit | null, press: Press, context: ToolContext): Gesture {
  if (press.shift && (!hit || hit.on === "state" || hit.on === "name" || hit.on === "line")) {
    return band(press, context);
  }
  if (!hit) return ground(press, context);
  if (context.machine.isInLibrary(hit.element.path)) return stateDrag(hit, press, context);
  switch (hit.on) {
    case "grip":
      return resizing(hit.element.path, hit.grip, press, context);
    case "port":
      return press.ctrl
        ? sliding(hit.element, press, context)
        : connecting(hit.element, press, context, false);
    case "end":
      return reconnecting(hit.element, hit.end, press, context);
    case "waypoint":
    case "middle":
    case "line":
      return withSelection(bent(hit, press, context), [hit.element]);
    case "breakpoint":
      return stateDrag(hit, press, context);
    case "name":
      if (press.ctrl && isSelected(hit.element, context)) {
        return naming(hit.element.path, hit.corner, press, context);
      }
      return stateDrag(hit, press, context);
    case "state":
      return stateDrag(hit, press, context);
  }
}

function bent(
  hit: Extract<CanvasHit, { readonly on: "waypoint" | "middle" | "line" }>,
  press: Press,
  context: ToolContext,
): Gesture {
  if (hit.on !== "line") {
    return bending(hit.element, hit.index, hit.on === "waypoint", press, context);
  }
  const route = routeOf(context.layout, hit.element);
  const index = route ? nearestPart(route, press, context.camera) : 0;
  return bending(hit.element, index, false, press, context);
}

function isSelected(element: ElementRef, { look }: ToolContext): boolean {
  return look.selection.has(keyOf(element));
}

/** Drag of a state. On the background of the root, or of a state that fills the view, it starts a rubber band instead. */
function stateDrag(hit: CanvasHit, press: Press, context: ToolContext): Gesture {
  const path = ownState(context.machine, hit.element.path);
  const element = { kind: "state", path } as const;
  if (press.isTouch && !isSelected(element, context)) return panning(press, context.camera);
  if (hit.on === "state" && isStage(hit.element.path, context)) return ground(press, context);
  if (parentOf(path) === null) return ground(press, context);
  const states = isSelected(element, context) ? movable(path, context) : [path];
  const gesture = moving(states.includes(path) ? states : [path], press, context);
  return isSelected(element, context) ? gesture : withSelection(gesture, [element]);
}

function withSelection(gesture: Gesture, select: readonly ElementRef[]): Gesture {
  return {
    ...gesture,
    select,
    move: (pointer, then) => withSelection(gesture.move(pointer, then), select),
  };
}

/** Selected states that move along with a state: its siblings. */
function movable(along: string, { look, machine }: ToolContext): readonly string[] {
  return [...look.selection].flatMap((key) => {
    const element = elementOf(key);
    const isOwn = element?.kind === "state" && !machine.isInLibrary(element.path);
    return isOwn && parentOf(element.path) === parentOf(along) ? [element.path] : [];
  });
}

function ground(press: Press, context: ToolContext): Gesture {
  return press.isTouch ? panning(press, context.camera) : band(press, context);
}

function band(press: Press, context: ToolContext): Gesture {
  const kept = [...context.look.selection].flatMap((key) => elementOf(key) ?? []);
  return banding(press, context, press.ctrl ? kept : []);
}

/** Cursor over the element that a press would take. */
export function cursorAt(hit: CanvasHit | null): string {
  switch (hit?.on) {
    case "grip":
      return cursorOf(hit.grip);
    case "port":
    case "end":
      return "crosshair";
    case "waypoint":
    case "middle":
      return "move";
    case "line":
    case "breakpoint":
      return "pointer";
    default:
      return "default";
  }
}
