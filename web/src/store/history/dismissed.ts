/** Commands without effect whose fate the user has seen, by run: they are not shown again. */

import { type Signal, signal } from "@preact/signals-core";
import type { Watch } from "./run.ts";

const SEEN = new WeakMap<Watch, Signal<ReadonlySet<string>>>();

/** Ids of commands. */
export function dismissed(watch: Watch): Signal<ReadonlySet<string>> {
  const known = SEEN.get(watch) ?? signal<ReadonlySet<string>>(new Set());
  SEEN.set(watch, known);
  return known;
}

export function dismiss(watch: Watch, id: string): void {
  const seen = dismissed(watch);
  seen.value = new Set([...seen.peek(), id]);
}
