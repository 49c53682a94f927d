/** With which other run a run is compared. */

import { type Signal, signal } from "@preact/signals-core";
import type { Watch } from "./run.ts";

const KNOWN = new WeakMap<Watch, Signal<string | null>>();

/** The id of the other run; null if it is compared with none. */
export function comparedRun(watch: Watch): Signal<string | null> {
  let known = KNOWN.get(watch);
  if (!known) {
    known = signal<string | null>(null);
    KNOWN.set(watch, known);
  }
  return known;
}
