/** Ways from one moment of a run to another: event by event, from entry to entry of a state, to the ends. */

import { callsOf, NONE } from "./calls.ts";
import { ENTERED, type Journal } from "./journal.ts";
import type { Watch } from "./run.ts";

type MomentWatch = Pick<Watch, "playhead" | "journal" | "window">;

/** So many events after a moment it is looked for what begins next. */
const NEAR = 1_000;

/** The index in the journal of the event after which everything is shown; -1 before the first. */
export function shownIndex({ playhead, window }: MomentWatch): number {
  const sequence = playhead.value;
  if (sequence === null) return window.length - 1;
  const index = window.indexOf(sequence + 1) - 1;
  return window.base ? Math.min(Math.max(index, window.first), window.length - 1) : index;
}

/** Shows the moment after an event of the part that is here; beside it the one that is next to it, beyond the last one what is now. */
export function showIndex({ window, journal, playhead }: MomentWatch, index: number): void {
  if (index >= window.length) playhead.value = window.next < journal.next ? window.next : null;
  else if (window.base && index < window.first) playhead.value = Math.max(1, window.from - 1);
  else if (window.length > 0) playhead.value = window.sequence(Math.max(0, index));
}

/** Goes so many events forward, or back. Forward from the last one is live. */
export function stepPlayhead(watch: MomentWatch, by: number): void {
  if (watch.playhead.peek() === null && by > 0) return;
  showIndex(watch, shownIndex(watch) + by);
}

/** The first or last event that one can go to. */
export function toEnd(watch: MomentWatch, end: "first" | "last"): void {
  if (end === "last") watch.playhead.value = null;
  else if (watch.journal.base) watch.playhead.value = 1;
  else showIndex(watch, 0);
}

/** The number of the event by which a state was entered before the moment that is shown, or after it; null if it was not, as far as
 * that is here. */
export function entryOf(
  watch: MomentWatch,
  path: string,
  direction: "before" | "after",
): number | null {
  const { window } = watch;
  const calls = callsOf(window);
  const begins = calls.of(path).map((call) => calls.begin(call));
  const now = shownIndex(watch);
  const found =
    direction === "before"
      ? begins.findLast((begin) => begin < now)
      : watch.playhead.value === null
        ? undefined
        : begins.find((begin) => begin > now);
  if (found !== undefined) return window.sequence(found);
  if (direction === "after") return null;
  const earlier = window.base?.earlier?.states.find((state) => state.path === path);
  return earlier?.entered?.sequence ?? null;
}

/** Goes to the entry of a state before the moment that is shown, or after it; false if there is none. */
export function toEntry(watch: MomentWatch, path: string, direction: "before" | "after"): boolean {
  const sequence = entryOf(watch, path, direction);
  if (sequence !== null) watch.playhead.value = sequence;
  return sequence !== null;
}

/** Whether what happened around a time is in a part of the run. */
export function hasTime({ journal }: Pick<Watch, "journal">, part: Journal, t_ns: number): boolean {
  if (part.length === part.first) return false;
  const isFrom = part.base === null || t_ns >= part.t_ns(part.first);
  return isFrom && (part === journal || t_ns <= part.t_ns(part.length - 1));
}

/** The last event up to a time of the run, if it is here; false if not. */
export function showTime(watch: MomentWatch, t_ns: number): boolean {
  const { journal, window, playhead } = watch;
  const part = [window, journal].find((each) => hasTime(watch, each, t_ns));
  if (!part) return false;
  const index = Math.max(part.first, part.indexAt(t_ns + 1) - 1);
  if (part.length > 0) playhead.value = part.sequence(index);
  return true;
}

/** The number of the entry at which the run would begin again to go on from the moment that is shown: that of the event itself, the
 * next one, else that of what ran then; null if nothing did. */
export function entryToStartFrom(watch: MomentWatch): number | null {
  const { window: journal } = watch;
  const now = Math.max(0, shownIndex(watch));
  for (let index = now; index < Math.min(journal.length, now + NEAR); index++) {
    if (journal.kind(index) === ENTERED && !journal.isBack(index)) return journal.sequence(index);
  }
  const calls = callsOf(journal);
  const call = calls.openAt(now);
  return call === NONE ? null : journal.sequence(calls.begin(call));
}
