/** Whether the canvas of a tab goes along with what runs. */

import { type Signal, signal } from "@preact/signals-core";
import type { RoomView } from "./view.ts";

const KNOWN = new WeakMap<RoomView, Signal<boolean>>();

export function isFollowed(view: RoomView): Signal<boolean> {
  let known = KNOWN.get(view);
  if (!known) {
    known = signal(false);
    KNOWN.set(view, known);
  }
  return known;
}
