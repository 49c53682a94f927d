/** Moves the camera along with the active states: only when one leaves the view or becomes too small to read. Following ends when
 * the user moves the camera. */

import { effect } from "@preact/signals-core";
import type { Box, Size } from "../../model/geometry.ts";
import { commonPath, parentOf } from "../../model/path.ts";
import type { OpenTab, Page } from "../../store/page/page.ts";
import type { Camera } from "../../store/page/view.ts";
import { activeStates, lanes, placeOfLane } from "../../store/run/active.ts";
import { extentOn } from "../hit/shown.ts";
import type { Layout } from "../layout/layout.ts";
import type { CanvasPicture } from "../picture.ts";
import { screenBox } from "./camera.ts";
import type { Flight } from "./flight.ts";
import { filling } from "./framing.ts";

/** Preferred and smallest size of an active state, in CSS pixels. */
const GOOD = 56;
const LEAST = 26;
/** Pixels of a state that may be outside the view. */
const SLACK = 1;
/** Smallest gain in scale that justifies a flight. A camera that moves all the time is hard to follow. */
const LARGER = 1.5;
/** Shortest pause between two flights, in ms. */
const REST_MS = 900;
/** Delay between a resize of the canvas and the next check, in ms. */
const RESIZED_MS = 150;

/** Camera that shows all these states: with the container around them, or closer if they would be too small. */
export function lookAtAll(layout: Layout, paths: readonly string[], size: Size): Camera | null {
  const shown = paths.flatMap((path) => innermost(layout, path) ?? []);
  const boxes = shown.map(({ box }) => box);
  const around = commonPath(shown.map(({ path }) => parentOf(path) ?? path));
  const outer = around === null ? undefined : layout.box(around);
  const wide = outer && filling([outer], size);
  if (wide && boxes.every((box) => extentOn(wide, box) >= GOOD)) return wide;
  const close = filling(boxes.map(withRoom), size);
  return close && wide && close.scale < wide.scale * LARGER ? wide : close;
}

/** Box with a margin of half its size on each side. */
function withRoom({ x, y, width, height }: Box): Box {
  return { x: x - width / 2, y: y - height / 2, width: 2 * width, height: 2 * height };
}

/** Camera for states that are out of sight, or too small while a closer view would help; null if the camera can stay. */
export function findAgain(
  layout: Layout,
  paths: readonly string[],
  camera: Camera,
  size: Size,
): Camera | null {
  const boxes = paths.flatMap((path) => innermost(layout, path)?.box ?? []);
  const isOut = boxes.some((box) => !isInSight(box, camera, size));
  const isTiny = boxes.some((box) => extentOn(camera, box) < LEAST);
  if (!isOut && !isTiny) return null;
  const wanted = lookAtAll(layout, paths, size);
  const isWorthIt = wanted !== null && (isOut || wanted.scale > camera.scale * LARGER);
  return isWorthIt ? wanted : null;
}

/** True if the whole box is in the view. A box larger than the view needs only its centre there. */
function isInSight(box: Box, camera: Camera, size: Size): boolean {
  const on = screenBox(camera, box);
  const across = isWithin(on.x, on.width, size.width);
  return across && isWithin(on.y, on.height, size.height);
}

function isWithin(start: number, length: number, whole: number): boolean {
  const middle = start + length / 2;
  if (length > whole) return middle >= 0 && middle <= whole;
  return start >= -SLACK && start + length <= whole + SLACK;
}

/** The state, or the innermost visible state around it. */
function innermost(layout: Layout, path: string): { path: string; box: Box } | null {
  for (let at: string | null = path; at !== null; at = parentOf(at)) {
    const box = layout.box(at);
    if (box) return { path: at, box };
  }
  return null;
}

/** Moves the camera while `follows` is on. Returns a function that stops it. */
export function followRun(
  { view, run }: OpenTab,
  page: Pick<Page, "tell">,
  picture: CanvasPicture,
  flight: Flight,
): () => void {
  const follows = view.follows;
  let goal: Camera | null = null;
  let last: Camera = view.camera.peek();
  let size = picture.size();
  let rest = 0;
  let isFirst = true;
  const look = () => {
    rest = 0;
    const watch = run.peek();
    if (!watch || !follows.peek()) return;
    const paths = lanes(activeStates(watch)).map(placeOfLane);
    const layout = picture.layout();
    const at = picture.size();
    const wanted = isFirst
      ? lookAtAll(layout, paths, at)
      : findAgain(layout, paths, flight.goal, at);
    if (!wanted) return;
    isFirst = false;
    goal = wanted;
    flight.to(wanted);
    rest = window.setTimeout(look, REST_MS);
  };
  const stopLooking = effect(() => {
    const watch = run.value;
    if (!follows.value || !watch) {
      isFirst = true;
      return;
    }
    activeStates(watch);
    if (rest === 0) look();
  });
  const stopGuarding = effect(() => {
    const camera = view.camera.value;
    const isMine = camera === last || flight.goal === goal;
    const before = size;
    last = camera;
    size = picture.size();
    const isResized = before.width !== size.width || before.height !== size.height;
    if (isResized && follows.peek() && rest === 0) rest = window.setTimeout(look, RESIZED_MS);
    if (isMine || isResized || !follows.peek()) return;
    follows.value = false;
    page.tell({
      level: "info",
      text: "The canvas no longer follows the active states because you moved it.",
      action: { title: "Follow again", command: "run.follow" },
    });
  });
  return () => {
    window.clearTimeout(rest);
    stopLooking();
    stopGuarding();
  };
}
