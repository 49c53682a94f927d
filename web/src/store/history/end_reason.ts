/** Reason of a failure, from the events of the last visit: an error, a logged error, a forced end, a cut. */

import { ABORTED } from "../../model/machine.ts";
import { isWithin } from "../../model/path.ts";
import { causeOfEvent, errorInWords, lastLine } from "./failures.ts";
import { ENTERED, type Journal, LEFT } from "./journal.ts";

export interface EndReason {
  /** The state that failed, or one inside it whose failure ended it. */
  readonly path: string;
  readonly text: string;
}

/** Greatest number of events to search. Few events separate the cause of a failure from its end, even in concurrency. */
const LOOK_MAX = 5_000;

/** Reason for the end at the index `left` of the visit that began at `entered`; null if no event reports one. */
export function endReasonAt(
  journal: Journal,
  path: string,
  entered: number,
  left: number,
): EndReason | null {
  for (let index = left; index > Math.max(entered, left - LOOK_MAX); index -= 1) {
    const reason = reasonIn(journal, index, path);
    if (reason) return reason;
    // A failure before the entry of an inner state was handled.
    if (journal.kind(index) === ENTERED && isInside(journal, index, path)) return null;
  }
  return null;
}

function isInside(journal: Journal, index: number, path: string): boolean {
  return isWithin(journal.pathOf(journal.pathNumber(index)), path);
}

function reasonIn(journal: Journal, index: number, path: string): EndReason | null {
  if (journal.kind(index) === LEFT) return reasonOfLeft(journal, index, path);
  const event = journal.other(index);
  if (event === undefined || !("path" in event) || !isWithin(event.path, path)) return null;
  if (event.type === "forced") {
    return { path: event.path, text: `it was forced to end with ${event.outcome.name}` };
  }
  const cause = causeOfEvent(event);
  if (!cause || (cause.kind === "log" && cause.level !== "error")) return null;
  return { path: event.path, text: cause.kind === "log" ? lastLine(cause.text) : cause.text };
}

function reasonOfLeft(journal: Journal, index: number, path: string): EndReason | null {
  const failed = journal.outcome(index)?.id === ABORTED || journal.hasError(index);
  if (!failed || journal.isBack(index) || !isInside(journal, index, path)) return null;
  const text = errorInWords(journal.error(index));
  return text === "" ? null : { path: journal.pathOf(journal.pathNumber(index)), text };
}
