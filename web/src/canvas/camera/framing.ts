/** Camera positions that show given elements. */

import { type Box, boundsOf, type Size } from "../../model/geometry.ts";
import type { Camera } from "../../store/page/view.ts";
import { fitted, screenBox } from "./camera.ts";

/** Margin around boxes that fill the view, in CSS pixels. */
const MARGIN = 40;

/** Camera that shows these boxes as large as they fit. */
export function filling(boxes: readonly Box[], size: Size): Camera | null {
  const box = boundsOf(boxes);
  return box && fitted(box, size, Math.min(MARGIN, size.width / 8, size.height / 8));
}

/** Smallest size of a readable state, in CSS pixels. */
const READABLE = 60;

/** Camera that makes the box visible and readable with as little movement as possible; unchanged if it is already. */
export function revealing(box: Box, camera: Camera, size: Size): Camera {
  const on = screenBox(camera, box);
  const isTooLarge = on.width > size.width || on.height > size.height;
  const isTooSmall = Math.min(on.width, on.height) < READABLE;
  if (isTooLarge) return fitted(box, size, MARGIN);
  if (!isTooSmall) return nudged(box, camera, size);
  const least = Math.min(box.width, box.height);
  const wanted = fitted(box, size, MARGIN);
  const scale = Math.min(wanted.scale, (READABLE * 2) / Math.max(least, 1e-9));
  return {
    x: box.x + box.width / 2 - size.width / 2 / scale,
    y: box.y + box.height / 2 - size.height / 2 / scale,
    scale,
  };
}

/** Moves the camera just enough to bring the box into the view. */
function nudged(box: Box, camera: Camera, size: Size): Camera {
  const on = screenBox(camera, box);
  const by = (start: number, length: number, whole: number) => {
    const margin = Math.max(0, Math.min(MARGIN, (whole - length) / 2));
    if (start < margin) return start - margin;
    return start + length > whole - margin ? start + length - whole + margin : 0;
  };
  const x = by(on.x, on.width, size.width);
  const y = by(on.y, on.height, size.height);
  if (x === 0 && y === 0) return camera;
  return { ...camera, x: camera.x + x / camera.scale, y: camera.y + y / camera.scale };
}
