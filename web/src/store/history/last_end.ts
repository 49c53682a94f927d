/** Finds the sibling of a state that ended last: the previous step of its branch. */

import type { Outcome } from "../../model/generated/protocol.ts";
import { parentOf } from "../../model/path.ts";
import { LEFT } from "./journal.ts";
import type { Watch } from "./run.ts";

export interface LastEnd {
  readonly path: string;
  readonly outcome: Outcome;
}

/** Number of events to search, backward from the shown moment. */
const LOOKED_AT = 500;

/** Last end of a sibling of a state at the shown moment; null if there was none recently. */
export function lastEndBeside(
  watch: Pick<Watch, "window" | "journalVersion" | "playhead">,
  path: string,
): LastEnd | null {
  watch.journalVersion.value;
  const playhead = watch.playhead.value;
  const { window: journal } = watch;
  const around = parentOf(path);
  if (around === null) return null;
  const end = playhead === null ? journal.length : journal.indexOf(playhead + 1);
  for (let index = end - 1; index >= Math.max(journal.first, end - LOOKED_AT); index -= 1) {
    if (journal.kind(index) !== LEFT) continue;
    const other = journal.pathOf(journal.pathNumber(index));
    const outcome = journal.outcome(index);
    if (outcome && parentOf(other) === around) return found(other, outcome);
  }
  return null;
}

const FOUND = new Map<string, LastEnd>();

/** Equal ends share one object, so that components do not render again. */
function found(path: string, outcome: Outcome): LastEnd {
  const key = `${path} ${outcome.id} ${outcome.name}`;
  const known = FOUND.get(key) ?? { path, outcome };
  FOUND.set(key, known);
  return known;
}
