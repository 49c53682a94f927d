/** The moment of a run that the page shows, in words. */

import { shownIndex } from "../../store/history/moments.ts";
import type { Watch } from "../../store/history/run.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { useSignal } from "../../ui/signals.ts";
import { sinceStart } from "./duration.ts";
import { happenedInWords, namesOf } from "./happened.ts";

interface MomentWords {
  /** Its place in the journal. */
  readonly index: number;
  /** Time since the start. */
  readonly when: string;
  /** The event. */
  readonly what: string;
}

export function useMoment(tab: OpenTab, watch: Watch): MomentWords {
  useSignal(watch.journalVersion);
  useSignal(watch.playhead);
  useSignal(tab.session.version);
  const index = shownIndex(watch);
  const happening = watch.journal.at(index);
  if (!happening) return { index, when: "", what: "Nothing has happened yet" };
  const when = sinceStart(happening.t_ns / 1e6, 1);
  return { index, when, what: happenedInWords(happening, namesOf(tab.session)) };
}
