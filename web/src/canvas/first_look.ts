/** Where the camera is when a machine is opened: where it was last in this browser tab, or with the whole machine in view. */

import type { OpenTab } from "../store/page.ts";
import type { Camera, RoomView } from "../store/view.ts";
import type { Hand } from "./hand.ts";
import { filling } from "./looks.ts";

/** Views whose camera has been set once: they keep it when their canvas comes back. */
const LOOKED = new WeakSet<RoomView>();

/** Sets the camera as soon as the place has a size, keeps the middle of the view when that changes, and remembers the camera
 * when the page is left. Returns the way to stop. */
export function firstLook(root: HTMLElement, tab: OpenTab, hand: Hand): () => void {
  const { view, room } = tab;
  const key = `rafcon.camera.${room.id}`;
  let [width, height] = [root.clientWidth, root.clientHeight];
  const look = () => {
    const known = LOOKED.has(view) ? view.camera.peek() : remembered(key);
    const box = hand.places().box(room.machine.root);
    const camera = known ?? (box && filling([box], { width, height }));
    if (!camera) return;
    LOOKED.add(view);
    view.camera.value = camera;
  };
  const sized = () => {
    const before = { width, height };
    [width, height] = [root.clientWidth, root.clientHeight];
    if (width === 0 || height === 0) return;
    if (!LOOKED.has(view)) look();
    else if (before.width > 0) view.camera.value = recentred(view.camera.peek(), before, root);
  };
  if (width > 0 && height > 0) look();
  const observer = new ResizeObserver(sized);
  observer.observe(root);
  const remember = () => {
    if (LOOKED.has(view)) sessionStorage.setItem(key, JSON.stringify(view.camera.peek()));
  };
  window.addEventListener("pagehide", remember);
  return () => {
    observer.disconnect();
    window.removeEventListener("pagehide", remember);
    remember();
  };
}

/** The camera with the same in the middle of a view of another size. */
function recentred(
  camera: Camera,
  before: { readonly width: number; readonly height: number },
  root: HTMLElement,
): Camera {
  const x = (before.width - root.clientWidth) / 2 / camera.scale;
  const y = (before.height - root.clientHeight) / 2 / camera.scale;
  return x === 0 && y === 0 ? camera : { ...camera, x: camera.x + x, y: camera.y + y };
}

function remembered(key: string): Camera | null {
  const text = sessionStorage.getItem(key);
  if (text === null) return null;
  try {
    const { x, y, scale } = JSON.parse(text) as Partial<Camera>;
    const isFine = [x, y, scale].every((part) => Number.isFinite(part)) && (scale ?? 0) > 0;
    return isFine ? { x: x ?? 0, y: y ?? 0, scale: scale ?? 1 } : null;
  } catch {
    return null;
  }
}
