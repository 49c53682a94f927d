/** Minimap in the corner: shows the whole machine with a frame around the visible area. Press or drag to move the view; the
 * button folds the map away. */

import { effect, signal } from "@preact/signals-core";
import type { Box, Point, Size } from "../../model/geometry.ts";
import { scaledContext } from "../../store/canvas_element.ts";
import type { OpenTab } from "../../store/page/page.ts";
import type { Camera } from "../../store/page/view.ts";
import { inkOf } from "../paint/ink.ts";
import { paint } from "../paint/paint.ts";
import type { CanvasPicture } from "../picture.ts";
import { fitted, screenBox, visibleBox, worldFromScreen } from "./camera.ts";
import { overview } from "./overview.ts";

const SIZE: Size = { width: 168, height: 104 };
/** Resolution factor: the map is painted larger and then scaled down, for more detail. */
const FINER = 4;
const MARGIN = 6;
const TIGHT = { width: 520, height: 300 };
/** Delay between a change of the machine and the repaint of the map, in ms. */
const REST_MS = 200;
/** Delay after a change of a run, in ms. Runs change all the time, so the map follows them less often. */
const RUN_REST_MS = 500;

interface Minimap {
  readonly dispose: () => void;
}

/** Adds the minimap to the corner of an element. */
export function minimapIn(
  place: HTMLElement,
  tab: OpenTab,
  picture: CanvasPicture,
  focus: () => void,
): Minimap {
  const box = frameIn(place);
  const map = canvasIn(box);
  const fold = buttonIn(box);
  const whole = document.createElement("canvas");
  const folded = signal(isTight(place));
  let isChosen = false;
  let rest = 0;

  const repaint = () => {
    rest = 0;
    paintWhole(whole, tab, picture);
    paintMap(map, whole, tab, picture);
  };
  const soon = (within = REST_MS) => {
    if (rest === 0) rest = window.setTimeout(repaint, within);
  };
  /** Folds the map if the canvas is small or everything is in view, unless the user has opened or folded it. */
  const foldAsFits = () => {
    if (!isChosen) folded.value = isTight(place) || isAllInView(tab, picture);
  };
  const stopFrames = picture.onFrame(() => {
    foldAsFits();
    if (!folded.peek()) paintMap(map, whole, tab, picture);
  });
  const stopFollowing = effect(() => {
    tab.session.version.value;
    tab.view.contents.value;
    tab.view.ghost.value;
    picture.theme.value;
    soon();
  });
  const stopRunning = effect(() => {
    picture.runs();
    if (!folded.value) soon(RUN_REST_MS);
  });
  const stopFolding = effect(() => {
    const isFolded = folded.value;
    map.style.display = isFolded ? "none" : "block";
    fold.style.position = isFolded ? "static" : "absolute";
    fold.textContent = isFolded ? "Overview" : "×";
    fold.setAttribute("aria-label", isFolded ? "Show the overview" : "Hide the overview");
    fold.setAttribute("aria-expanded", String(!isFolded));
    if (!isFolded) soon();
  });
  fold.addEventListener("click", () => {
    isChosen = true;
    folded.value = !folded.peek();
  });
  const observer = new ResizeObserver(foldAsFits);
  observer.observe(place);
  listen(map, (at) => {
    focus();
    lookAt(tab, picture, at);
  });

  return {
    dispose: () => {
      window.clearTimeout(rest);
      observer.disconnect();
      stopFrames();
      stopFollowing();
      stopRunning();
      stopFolding();
      box.remove();
    },
  };
}

function isAllInView({ view }: OpenTab, picture: CanvasPicture): boolean {
  const root = rootBox(picture);
  if (!root) return false;
  const on = screenBox(view.camera.peek(), root);
  const { width, height } = picture.size();
  return on.x >= 0 && on.y >= 0 && on.x + on.width <= width && on.y + on.height <= height;
}

/** True if the map would hide much of the canvas. */
function isTight({ clientWidth, clientHeight }: HTMLElement): boolean {
  return clientWidth < TIGHT.width || clientHeight < TIGHT.height;
}

function frameIn(place: HTMLElement): HTMLElement {
  const box = document.createElement("div");
  box.className = "canvas-minimap";
  box.style.cssText = [
    "position:absolute;right:14px;bottom:14px;border:1px solid var(--border)",
    "border-radius:var(--radius);background:var(--surface);overflow:hidden;box-shadow:var(--shadow)",
  ].join(";");
  place.append(box);
  return box;
}

function canvasIn(box: HTMLElement): HTMLCanvasElement {
  const map = document.createElement("canvas");
  map.style.cssText = `display:block;width:${SIZE.width}px;height:${SIZE.height}px;touch-action:none;cursor:pointer`;
  map.setAttribute("aria-hidden", "true");
  box.append(map);
  return map;
}

function buttonIn(box: HTMLElement): HTMLButtonElement {
  const fold = document.createElement("button");
  fold.type = "button";
  fold.style.cssText = [
    "position:absolute;right:2px;top:2px;min-width:var(--row);height:var(--row);padding:0 6px;border:0",
    "border-radius:var(--radius-small);background:var(--surface);color:var(--text-soft)",
    "font:500 var(--text-tiny)/1 var(--font-text);cursor:pointer",
  ].join(";");
  box.append(fold);
  return fold;
}

/** Calls back with the position of the pointer while it is pressed. */
function listen(map: HTMLCanvasElement, tell: (at: Point) => void): void {
  const onPointer = (event: PointerEvent) => tell({ x: event.offsetX, y: event.offsetY });
  map.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    // The keyboard focus stays on the canvas.
    event.preventDefault();
    map.setPointerCapture(event.pointerId);
    onPointer(event);
  });
  map.addEventListener("pointermove", (event) => {
    if (map.hasPointerCapture(event.pointerId)) onPointer(event);
  });
}

/** Camera of the map: it shows the whole machine. */
function mapCamera(root: Box): Camera {
  return fitted(root, SIZE, MARGIN);
}

function rootBox(picture: CanvasPicture): Box | undefined {
  const layout = picture.layout();
  return layout.root ? layout.box(layout.root.path) : undefined;
}

function lookAt({ view }: OpenTab, picture: CanvasPicture, at: Point): void {
  const root = rootBox(picture);
  if (!root) return;
  const world = worldFromScreen(mapCamera(root), at);
  const camera = view.camera.peek();
  const { width, height } = picture.size();
  view.camera.value = {
    ...camera,
    x: world.x - width / 2 / camera.scale,
    y: world.y - height / 2 / camera.scale,
  };
}

function paintWhole(whole: HTMLCanvasElement, { view }: OpenTab, picture: CanvasPicture): void {
  const size = { width: SIZE.width * FINER, height: SIZE.height * FINER };
  const context = scaledContext(whole, size);
  const root = rootBox(picture);
  if (!context || !root) return;
  const colours = picture.colours();
  context.fillStyle = inkOf(colours, "ground");
  context.fillRect(0, 0, size.width, size.height);
  const seen = { layout: picture.layout(), camera: fitted(root, size, MARGIN * FINER), view: size };
  const shown = { modes: view.modes.peek(), runs: picture.runs(), ghost: view.ghost.peek() };
  paint(context, overview({ ...seen, ...shown, line: FINER }), colours);
}

function paintMap(
  map: HTMLCanvasElement,
  whole: HTMLCanvasElement,
  { view }: OpenTab,
  picture: CanvasPicture,
): void {
  const context = scaledContext(map, SIZE);
  const root = rootBox(picture);
  if (!context || !root || whole.width === 0) return;
  context.imageSmoothingQuality = "high";
  context.drawImage(whole, 0, 0, SIZE.width, SIZE.height);
  const camera = mapCamera(root);
  const seen = visibleBox(view.camera.peek(), picture.size());
  const x = (seen.x - camera.x) * camera.scale;
  const y = (seen.y - camera.y) * camera.scale;
  const width = Math.max(4, seen.width * camera.scale);
  const height = Math.max(4, seen.height * camera.scale);
  context.strokeStyle = inkOf(picture.colours(), "selection");
  context.lineWidth = 1.5;
  context.strokeRect(x, y, width, height);
}
