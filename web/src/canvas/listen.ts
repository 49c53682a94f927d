/** Translates pointer, wheel, key and drag events of the browser for the interaction controller. */

import type { ElementRef } from "../model/element.ts";
import { distance, type Point } from "../model/geometry.ts";
import type { Dragged } from "../store/page/dragged.ts";
import type { InteractionController } from "./interaction.ts";
import type { ReaderTree } from "./reader/reader.ts";
import type { Pointer } from "./tools/gesture.ts";

interface Hearers {
  readonly controller: InteractionController;
  readonly reader: ReaderTree;
  /** Object that is dragged onto the canvas. */
  readonly dragged: () => Dragged | null;
  /** Called when the user takes over a camera that moves by itself. */
  readonly interrupt: () => void;
  readonly choose: (element: ElementRef) => void;
  /** Opens the menu: at a point of the view, or without one if requested by keyboard. */
  readonly menu: (at: Point | null) => void;
}

const LEFT = 0;
const MIDDLE = 1;

/** Listens at the element until the returned function is called. */
export function listen(root: HTMLElement, hearers: Hearers): () => void {
  const stop = new AbortController();
  const { signal } = stop;
  pointers(root, hearers, signal);
  keys(root, hearers, signal);
  drags(root, hearers, signal);
  return () => stop.abort();
}

function pointerOf(root: HTMLElement, event: MouseEvent): Pointer {
  const { left, top } = root.getBoundingClientRect();
  return { x: event.clientX - left, y: event.clientY - top, ...modifiers(event) };
}

function modifiers(event: MouseEvent | KeyboardEvent) {
  return { shift: event.shiftKey, ctrl: event.ctrlKey || event.metaKey, alt: event.altKey };
}

function fingerOf(event: PointerEvent): { readonly finger?: number } {
  return event.pointerType === "touch" ? { finger: event.pointerId } : {};
}

/** Elements with the space key held down. The pointer pans the view meanwhile. */
const SPACE = new WeakSet<HTMLElement>();

function pointers(
  root: HTMLElement,
  { controller, interrupt, menu }: Hearers,
  signal: AbortSignal,
): void {
  const on = <K extends keyof HTMLElementEventMap>(
    name: K,
    hear: (event: HTMLElementEventMap[K]) => void,
    options: AddEventListenerOptions = {},
  ) => root.addEventListener(name, hear, { ...options, signal });
  const rest = longPress((at) => {
    controller.cancel();
    menu(at);
  });
  signal.addEventListener("abort", rest.end);
  on("pointerdown", (event) => {
    if (event.pointerType === "touch") rest.begin(pointerOf(root, event), event.pointerId);
    if (event.button !== LEFT && event.button !== MIDDLE) return;
    event.preventDefault();
    interrupt();
    root.focus({ preventScroll: true });
    root.setPointerCapture(event.pointerId);
    const pans = event.button === MIDDLE || SPACE.has(root);
    const press = { ...pointerOf(root, event), isTouch: event.pointerType === "touch" };
    controller.press(press, { pans, ...fingerOf(event) });
  });
  on("pointermove", (event) => {
    rest.moved(pointerOf(root, event));
    controller.move(pointerOf(root, event), fingerOf(event).finger);
  });
  const isSecondTap = doubleTap();
  on("pointerup", (event) => {
    const pointer = pointerOf(root, event);
    rest.end();
    controller.release(pointer, fingerOf(event).finger);
    if (event.pointerType === "touch" && isSecondTap(pointer, event.timeStamp)) {
      controller.doubleClick(pointer);
    }
  });
  on("pointercancel", (event) => {
    rest.end();
    controller.cancel();
    controller.release(pointerOf(root, event), fingerOf(event).finger);
  });
  on("pointerleave", () => controller.leave());
  on("dblclick", (event) => {
    if (event.button === LEFT) controller.doubleClick(pointerOf(root, event));
  });
  on("contextmenu", (event) => {
    event.preventDefault();
    // The key listener opens the menu already. Browsers send this event without a pointer for keys.
    const isByKey = event.button !== 2 && !(event instanceof PointerEvent && event.pointerType);
    if (!isByKey) menu(pointerOf(root, event));
  });
  on(
    "wheel",
    (event) => {
      event.preventDefault();
      interrupt();
      const { deltaX, deltaY, deltaMode } = event;
      const { ctrl, shift } = modifiers(event);
      controller.turn(pointerOf(root, event), { deltaX, deltaY, deltaMode, ctrl, shift });
    },
    { passive: false },
  );
}

const RESTS_MS = 500;
const RESTS_WITHIN = 10;

/** Opens the menu after a long press. Not all browsers send a `contextmenu` event for it. */
function longPress(rested: (at: Point) => void) {
  let waiting: { readonly from: Point; readonly finger: number; readonly timer: number } | null =
    null;
  const end = () => {
    window.clearTimeout(waiting?.timer);
    waiting = null;
  };
  return {
    /** A second finger zooms, and cancels the long press. */
    begin: (from: Point, finger: number) => {
      const isSecond = waiting !== null;
      end();
      if (isSecond) return;
      const timer = window.setTimeout(() => {
        waiting = null;
        rested(from);
      }, RESTS_MS);
      waiting = { from, finger, timer };
    },
    moved: (at: Point) => {
      if (waiting && distance(at, waiting.from) > RESTS_WITHIN) end();
    },
    end,
  };
}

const TAPS_WITHIN_MS = 350;
const TAPS_WITHIN = 24;

/** Detects a double tap. Browsers send no `dblclick` event for touches on a canvas. */
function doubleTap(): (at: Point, time: number) => boolean {
  let last: { readonly at: Point; readonly time: number } | null = null;
  return (at, time) => {
    const isSecond =
      last !== null && time - last.time <= TAPS_WITHIN_MS && distance(at, last.at) <= TAPS_WITHIN;
    last = isSecond ? null : { at, time };
    return isSecond;
  };
}

const MODIFIERS = new Set(["Shift", "Control", "Alt", "Meta"]);

function keys(
  root: HTMLElement,
  { controller, reader, choose, menu }: Hearers,
  signal: AbortSignal,
): void {
  root.addEventListener(
    "keydown",
    (event) => {
      if (MODIFIERS.has(event.key)) changeModifiers(controller, event);
      const isUsed = controller.key({ key: event.key, ...modifiers(event) });
      const isMenu = event.key === "ContextMenu" || (event.key === "F10" && event.shiftKey);
      if (!isUsed && isMenu) menu(null);
      const pans = !isUsed && event.key === " ";
      if (pans) SPACE.add(root);
      if (isUsed || isMenu || pans) {
        event.preventDefault();
        event.stopPropagation();
      }
    },
    { signal },
  );
  root.addEventListener(
    "keyup",
    (event) => {
      if (event.key === " ") SPACE.delete(root);
      if (MODIFIERS.has(event.key)) changeModifiers(controller, event);
    },
    { signal },
  );
  root.addEventListener("blur", () => SPACE.delete(root), { signal });
  root.addEventListener(
    "click",
    (event) => {
      const element = reader.elementOf(event.target);
      if (element) choose(element);
    },
    { signal },
  );
}

/** During a gesture Alt belongs to the gesture, and must not open the browser's menu. */
function changeModifiers(controller: InteractionController, event: KeyboardEvent): void {
  if (controller.doing !== null) event.preventDefault();
  controller.modifiers(modifiers(event));
}

function drags(root: HTMLElement, { controller, dragged }: Hearers, signal: AbortSignal): void {
  const over = (event: DragEvent) => {
    const what = dragged();
    if (!what) return;
    event.preventDefault();
    if (event.dataTransfer) event.dataTransfer.dropEffect = "copy";
    controller.bring(what, pointerOf(root, event));
  };
  root.addEventListener("dragenter", over, { signal });
  root.addEventListener("dragover", over, { signal });
  root.addEventListener(
    "dragleave",
    (event) => {
      const to = event.relatedTarget;
      if (!(to instanceof Node && root.contains(to))) controller.cancel();
    },
    { signal },
  );
  root.addEventListener(
    "drop",
    (event) => {
      if (!dragged()) return;
      event.preventDefault();
      root.focus({ preventScroll: true });
      controller.drop();
    },
    { signal },
  );
}
