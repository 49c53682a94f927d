/** Ways from one moment of a run to another: event by event, from entry to entry of a state, to the ends. */

import { callsOf, NONE } from "./calls.ts";
import { ENTERED } from "./journal.ts";
import type { Watch } from "./run.ts";

/** So many events after a moment it is looked for what begins next. */
const NEAR = 1_000;

/** The index in the journal of the event after which everything is shown; -1 before the first. */
export function shownIndex({ playhead, journal }: Watch): number {
  const sequence = playhead.value;
  return sequence === null ? journal.length - 1 : journal.indexOf(sequence + 1) - 1;
}

/** Shows the moment after an event of the journal; beyond the last one what is now. */
export function showIndex(watch: Watch, index: number): void {
  const { journal, playhead } = watch;
  if (index >= journal.length) playhead.value = null;
  else if (journal.length > 0) playhead.value = journal.sequence(Math.max(0, index));
}

/** Goes so many events forward, or back. Forward from the last one is live. */
export function stepPlayhead(watch: Watch, by: number): void {
  if (watch.playhead.peek() === null && by > 0) return;
  showIndex(watch, shownIndex(watch) + by);
}

/** The first or last event that one can go to. */
export function toEnd(watch: Watch, end: "first" | "last"): void {
  if (end === "first") showIndex(watch, 0);
  else watch.playhead.value = null;
}

/** The event by which a state was entered before the moment that is shown, or after it; null if it was not. */
export function entryOf(watch: Watch, path: string, direction: "before" | "after"): number | null {
  const calls = callsOf(watch.journal);
  const begins = calls.of(path).map((call) => calls.begin(call));
  const now = shownIndex(watch);
  const found =
    direction === "before"
      ? begins.findLast((begin) => begin < now)
      : watch.playhead.value === null
        ? undefined
        : begins.find((begin) => begin > now);
  return found ?? null;
}

/** Goes to the entry of a state before the moment that is shown, or after it; false if there is none. */
export function toEntry(watch: Watch, path: string, direction: "before" | "after"): boolean {
  const index = entryOf(watch, path, direction);
  if (index !== null) showIndex(watch, index);
  return index !== null;
}

/** The last event up to a time of the run. */
export function showTime(watch: Watch, t_ns: number): void {
  showIndex(watch, Math.max(0, watch.journal.indexAt(t_ns + 1) - 1));
}

/** The number of the entry at which the run would begin again to go on from the moment that is shown: that of the event itself, the
 * next one, else that of what ran then; null if nothing did. */
export function entryToStartFrom(watch: Watch): number | null {
  const { journal } = watch;
  const now = Math.max(0, shownIndex(watch));
  for (let index = now; index < Math.min(journal.length, now + NEAR); index++) {
    if (journal.kind(index) === ENTERED && !journal.isBack(index)) return journal.sequence(index);
  }
  const calls = callsOf(journal);
  const call = calls.openAt(now);
  return call === NONE ? null : journal.sequence(calls.begin(call));
}
