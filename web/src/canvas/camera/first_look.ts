/** Camera of a machine when it is first shown: the kept one of its view, or the whole machine. */

import type { Box, Size } from "../../model/geometry.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { type Camera, FIRST_CAMERA } from "../../store/page/view.ts";
import type { InteractionController } from "../interaction.ts";
import { screenBox } from "./camera.ts";
import { filling } from "./framing.ts";

/** Sets the camera as soon as the canvas has a size. After a resize the centre of the view, or the whole machine, stays visible.
 * Returns a function that stops this. */
export function firstLook(
  root: HTMLElement,
  tab: OpenTab,
  controller: InteractionController,
): () => void {
  const { view, session } = tab;
  const box = () => controller.layout().box(session.machine.root) ?? null;
  const sized = () => {
    const size = { width: root.clientWidth, height: root.clientHeight };
    if (size.width === 0 || size.height === 0) return;
    const before = view.canvasSize.peek();
    const camera = before
      ? resized(view.camera.peek(), box(), before, size)
      : firstCamera(view.camera.peek(), box(), size);
    if (!camera) return;
    view.canvasSize.value = size;
    view.camera.value = camera;
  };
  sized();
  const observer = new ResizeObserver(sized);
  observer.observe(root);
  return () => observer.disconnect();
}

/** The kept camera, also in another browser tab. */
function firstCamera(kept: Camera, machine: Box | null, size: Size): Camera | null {
  return kept === FIRST_CAMERA ? lookAtMachine(machine, size) : kept;
}

function lookAtMachine(machine: Box | null, size: Size): Camera | null {
  return machine && filling([machine], size);
}

/** Camera after a resize: it keeps the centre, or fits the whole machine if that was fitted before. */
export function resized(camera: Camera, machine: Box | null, before: Size, after: Size): Camera {
  if (before.width === after.width && before.height === after.height) return camera;
  const fitted = lookAtMachine(machine, before);
  if (fitted && isSame(fitted, camera)) return lookAtMachine(machine, after) ?? camera;
  const x = (before.width - after.width) / 2 / camera.scale;
  const y = (before.height - after.height) / 2 / camera.scale;
  const middle = { ...camera, x: camera.x + x, y: camera.y + y };
  const wasWhole = machine && isWhole(machine, camera, before);
  return wasWhole && !isWhole(machine, middle, after)
    ? (lookAtMachine(machine, after) ?? middle)
    : middle;
}

function isSame(one: Camera, other: Camera): boolean {
  const off = Math.hypot(one.x - other.x, one.y - other.y) * one.scale;
  return off < 1 && Math.abs(one.scale / other.scale - 1) < 1e-3;
}

/** True if the whole box is in the view. */
function isWhole(box: Box, camera: Camera, size: Size): boolean {
  const on = screenBox(camera, box);
  return on.x >= 0 && on.y >= 0 && on.x + on.width <= size.width && on.y + on.height <= size.height;
}
