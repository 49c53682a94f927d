/** Whether the canvas of a tab goes along with what runs. */

import { type Signal, signal } from "@preact/signals-core";
import type { SessionView } from "./view.ts";

const KNOWN = new WeakMap<SessionView, Signal<boolean>>();

export function followedSignal(view: SessionView): Signal<boolean> {
  let known = KNOWN.get(view);
  if (!known) {
    known = signal(false);
    KNOWN.set(view, known);
  }
  return known;
}
