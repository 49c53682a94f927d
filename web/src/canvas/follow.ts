/** The camera goes along with what runs: not at each change, only when it leaves the view or becomes too small to be read. Whoever
 * moves the camera takes it over. */

import { effect } from "@preact/signals-core";
import type { Box, Size } from "../model/geometry.ts";
import { commonPath, parentOf } from "../model/path.ts";
import type { OpenTab, Page } from "../store/page/page.ts";
import type { Camera } from "../store/page/view.ts";
import { activeStates, lanes, placeOfLane } from "../store/run/active.ts";
import { screenBox } from "./camera.ts";
import type { Flight } from "./flight.ts";
import { extentOn } from "./hit/shown.ts";
import type { Layout } from "./layout.ts";
import { filling } from "./looks.ts";
import type { CanvasPicture } from "./picture.ts";

/** What runs is to be seen in this size, in CSS pixels, and no smaller than this. */
const GOOD = 56;
const LEAST = 26;
/** So many pixels may be out of sight. */
const SLACK = 1;
/** The camera goes closer if that makes things so many times larger: what moves all the time is not looked at. */
const LARGER = 1.5;
/** So long the camera rests between two flights, however much happens. */
const REST_MS = 900;
/** It looks again so soon after its place became larger or smaller. */
const RESIZED_MS = 150;

/** Where to look so that all these places can be seen: at what is around them all, or closer if they would be too small. */
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

/** Half of itself on each side. */
function withRoom({ x, y, width, height }: Box): Box {
  return { x: x - width / 2, y: y - height / 2, width: 2 * width, height: 2 * height };
}

/** Where to go if a place is out of sight, or too small while it could be much larger; null if the camera is fine. */
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

/** Whether all of a box is in the view; of one that is larger than the view, its middle. */
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

/** The state, or the innermost one around it that is shown. */
function innermost(layout: Layout, path: string): { path: string; box: Box } | null {
  for (let at: string | null = path; at !== null; at = parentOf(at)) {
    const box = layout.box(at);
    if (box) return { path: at, box };
  }
  return null;
}

/** Follows while it is asked to. Returns the way to stop. */
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
