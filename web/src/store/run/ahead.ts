/** Watched values of a robot's run that arrive ahead of their events, while older events are still missing. */

import type { WatchedValue, WatchTarget } from "../../model/generated/protocol.ts";
import { aheadKey } from "../history/ahead.ts";
import type { Watch } from "../history/run.ts";
import type { Target } from "./watched_values.ts";

/** The value, if its event is still missing and the present is shown. */
export function aheadOf(watch: Watch, target: Target): WatchedValue | null {
  const found = watch.ahead.value.values.get(aheadKey(target));
  if (!found || watch.playhead.value !== null) return null;
  watch.journalVersion.value;
  return found.sequence >= watch.journal.next ? found : null;
}

/** Watch request to the server: single values before whole states, earlier watches first. */
export function wishOf(
  targets: readonly Target[],
  states: readonly string[] = [],
): readonly WatchTarget[] {
  const known = new Set<string>();
  const wish: WatchTarget[] = [];
  const whole = states.map((path) => ({ kind: "state", path, name: "" }) as const);
  for (const { kind, path, name } of [...targets, ...whole]) {
    const target = { kind, path, name, priority: Math.min(wish.length, 255) };
    if (known.has(aheadKey(target))) continue;
    known.add(aheadKey(target));
    wish.push(target);
  }
  return wish;
}
