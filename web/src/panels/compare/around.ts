/** Events of one branch around a moment of a run: a few entries and ends before it, the event itself, and a few after it. */

import { isWithin } from "../../model/path.ts";
import { type Journal, OTHER } from "../../store/history/journal.ts";

const BEFORE = 4;
const AFTER = 4;
/** Maximum number of events that are searched in each direction. */
const FAR = 5_000;

/** Indices in the journal, in order. `sequence` is the event at which the runs differ; null if this run was over by then. */
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
