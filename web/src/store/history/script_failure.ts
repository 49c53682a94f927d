/** What the log says of an error by which a state ended: the traceback that was written last before it. */

import { isWithin } from "../../model/path.ts";
import { readTraceback, type Traceback } from "../../model/traceback.ts";
import type { Journal } from "./journal.ts";

/** What happened between a script's error and its state's end is little, even in concurrency. */
const LOOK_MAX = 5_000;

export interface ScriptFailure {
  readonly traceback: Traceback;
  /** The whole text. */
  readonly text: string;
  /** The state whose script failed: the one that ended, or one inside it. */
  readonly path: string;
}

/** The traceback behind the end of a state, between the indices of its entry and its end; null if none was written, or too long
 * ago. */
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
