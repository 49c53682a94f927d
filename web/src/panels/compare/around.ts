/** What happened in a run around a moment, on one branch: a few entries and ends before it, itself, and a few after. */

import { isWithin } from "../../model/path.ts";
import { type Journal, OTHER } from "../../store/history/journal.ts";

const BEFORE = 4;
const AFTER = 4;
/** So many events are looked through at most, to either side. */
const FAR = 5_000;

/** Indices in the journal, in order. The number is that of the event at which the runs part; null: the run was over by then. */
export function entriesAround(
  journal: Journal,
  branch: string,
  sequence: number | null,
): readonly number[] {
  const at = sequence === null ? journal.length : journal.indexOf(sequence);
  const before: number[] = [];
  for (
    let index = at - 1;
    index >= Math.max(journal.first, at - FAR) && before.length < BEFORE;
    index--
  ) {
    if (isOn(journal, branch, index)) before.unshift(index);
  }
  const from: number[] = [];
  const until = Math.min(journal.length, at + FAR);
  for (let index = at; index < until && from.length <= AFTER; index++) {
    if (index === at || isOn(journal, branch, index)) from.push(index);
  }
  return [...before, ...from];
}

function isOn(journal: Journal, branch: string, index: number): boolean {
  if (journal.kind(index) === OTHER) return false;
  return isWithin(journal.pathOf(journal.pathNumber(index)), branch);
}
