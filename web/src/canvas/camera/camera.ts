/** Conversion between the root's coordinates and CSS pixels of the view, and camera movements. All functions are pure. */

import type { Box, Point, Size } from "../../model/geometry.ts";
import type { Camera } from "../../store/page/view.ts";

/** Limits of the zoom, in CSS pixels per unit of the root. */
const SCALE_MIN = 1e-4;
const SCALE_MAX = 1e7;

export function screenFromWorld(camera: Camera, point: Point): Point {
  return { x: (point.x - camera.x) * camera.scale, y: (point.y - camera.y) * camera.scale };
}

export function worldFromScreen(camera: Camera, point: Point): Point {
  return { x: point.x / camera.scale + camera.x, y: point.y / camera.scale + camera.y };
}

export function screenBox(camera: Camera, box: Box): Box {
  const at = screenFromWorld(camera, box);
  return { ...at, width: box.width * camera.scale, height: box.height * camera.scale };
}

/** Visible area for a view of this size, in the root's coordinates. */
export function visibleBox(camera: Camera, view: Size): Box {
  return {
    x: camera.x,
    y: camera.y,
    width: view.width / camera.scale,
    height: view.height / camera.scale,
  };
}

/** Zooms and keeps the point under `at` in place. */
export function zoomedAt(camera: Camera, at: Point, factor: number): Camera {
  const scale = Math.min(SCALE_MAX, Math.max(SCALE_MIN, camera.scale * factor));
  const fixed = worldFromScreen(camera, at);
  return { x: fixed.x - at.x / scale, y: fixed.y - at.y / scale, scale };
}

/** Moves the content by this many CSS pixels. */
export function panned(camera: Camera, by: Point): Camera {
  return { ...camera, x: camera.x - by.x / camera.scale, y: camera.y - by.y / camera.scale };
}

/** Camera that shows the whole box, centred, with a margin in CSS pixels. */
export function fitted(box: Box, view: Size, margin: number): Camera {
  const width = Math.max(1, view.width - 2 * margin);
  const height = Math.max(1, view.height - 2 * margin);
  const wanted = Math.min(width / Math.max(box.width, 1e-9), height / Math.max(box.height, 1e-9));
  const scale = Math.min(SCALE_MAX, Math.max(SCALE_MIN, wanted));
  return {
    x: box.x + box.width / 2 - view.width / 2 / scale,
    y: box.y + box.height / 2 - view.height / 2 / scale,
    scale,
  };
}

/** Camera between two others, for `part` from 0 to 1. The zoom appears even to the eye, about the point that stays in place. */
export function flight(from: Camera, to: Camera, part: number): Camera {
  if (part >= 1) return to;
  const scale = from.scale * (to.scale / from.scale) ** part;
  const even = Math.abs(to.scale / from.scale - 1) < 1e-6;
  const travelled = even ? part : (1 / from.scale - 1 / scale) / (1 / from.scale - 1 / to.scale);
  return {
    x: from.x + (to.x - from.x) * travelled,
    y: from.y + (to.y - from.y) * travelled,
    scale,
  };
}
