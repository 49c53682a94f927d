/** Moves between moments of a run: event by event, between entries of a state, to the ends. */

import { callsOf, NONE } from "./calls.ts";
import { ENTERED, type Journal } from "./journal.ts";
import type { Watch } from "./run.ts";

type MomentWatch = Pick<Watch, "playhead" | "journal" | "window">;

/** Number of events after a moment that are searched for the next entry. */
const NEAR = 1_000;

/** Index of the last event that is shown; -1 before the first. */
export function shownIndex({ playhead, window }: MomentWatch): number {
  const sequence = playhead.value;
  if (sequence === null) return window.length - 1;
  const index = window.indexOf(sequence + 1) - 1;
  return window.base ? Math.min(Math.max(index, window.first), window.length - 1) : index;
}

/** Moves the playhead to an event of the loaded part. An index before the part moves to the event before it. An index after it
 * moves to the next event, or to live. */
export function showIndex({ window, journal, playhead }: MomentWatch, index: number): void {
  if (index >= window.length) playhead.value = window.next < journal.next ? window.next : null;
  else if (window.base && index < window.first) playhead.value = Math.max(1, window.from - 1);
  else if (window.length > 0) playhead.value = window.sequence(Math.max(0, index));
}

/** Moves the playhead by this number of events. After the last event it becomes live. */
export function stepPlayhead(watch: MomentWatch, by: number): void {
  if (watch.playhead.peek() === null && by > 0) return;
  showIndex(watch, shownIndex(watch) + by);
}

/** Moves to the first event, or to live. */
export function toEnd(watch: MomentWatch, end: "first" | "last"): void {
  if (end === "last") watch.playhead.value = null;
  else if (watch.journal.base) watch.playhead.value = 1;
  else showIndex(watch, 0);
}

/** Sequence number of the last entry of a state before the shown moment, or of the first after it; null if it is not loaded or does
 * not exist. */
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

/** Moves to an entry of a state before or after the shown moment; false if none is found. */
export function toEntry(watch: MomentWatch, path: string, direction: "before" | "after"): boolean {
  const sequence = entryOf(watch, path, direction);
  if (sequence !== null) watch.playhead.value = sequence;
  return sequence !== null;
}

/** True if a part of the run contains the events around a time. */
export function hasTime({ journal }: Pick<Watch, "journal">, part: Journal, t_ns: number): boolean {
  if (part.length === part.first) return false;
  const isFrom = part.base === null || t_ns >= part.t_ns(part.first);
  return isFrom && (part === journal || t_ns <= part.t_ns(part.length - 1));
}

/** Moves to the last event up to a time of the run; false if it is not loaded. */
export function showTime(watch: MomentWatch, t_ns: number): boolean {
  const { journal, window, playhead } = watch;
  const part = [window, journal].find((each) => hasTime(watch, each, t_ns));
  if (!part) return false;
  const index = Math.max(part.first, part.indexAt(t_ns + 1) - 1);
  if (part.length > 0) playhead.value = part.sequence(index);
  return true;
}

/** Sequence number of the entry to restart from to continue from the shown moment: that of the event itself or the next entry,
 * otherwise that of the innermost active state; null if none was active. */
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
