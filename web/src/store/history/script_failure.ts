/** Traceback of the error that ended a state: the last one logged before the end. */

import { isWithin } from "../../model/path.ts";
import { readTraceback, type Traceback } from "../../model/traceback.ts";
import type { Journal } from "./journal.ts";

/** Greatest number of events to search. Few events separate a script's error from the end of its state, even in concurrency. */
const LOOK_MAX = 5_000;

export interface ScriptFailure {
  readonly traceback: Traceback;
  /** Whole text of the log line. */
  readonly text: string;
  /** State whose script failed: the one that ended, or one inside it. */
  readonly path: string;
}

/** Traceback of the end of a state, between the indices of its entry and end; null if there is none within `LOOK_MAX` events. */
export function failureAt(
  journal: Journal,
  path: string,
  entered: number,
  left: number,
): ScriptFailure | null {
  for (let index = left; index >= Math.max(entered, left - LOOK_MAX); index -= 1) {
    const event = journal.other(index);
    if (event?.type !== "log" || event.level !== "error" || !isWithin(event.path, path)) continue;
    const traceback = readTraceback(event.message);
    if (traceback) return { traceback, text: event.message, path: event.path };
  }
  return null;
}
