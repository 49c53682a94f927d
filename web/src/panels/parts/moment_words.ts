/** Shown moment of a run as text. */

import { shownIndex } from "../../store/history/moments.ts";
import type { Watch } from "../../store/history/run.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { runTime, timeScale } from "../../store/page/times.ts";
import { useSignal } from "../../ui/signals.ts";
import { happenedInWords, namesOf } from "./happened.ts";

interface MomentWords {
  /** Index of the event in the journal. */
  readonly index: number;
  /** Time on the scale from the settings. */
  readonly when: string;
  /** Description of the event. */
  readonly what: string;
}

export function useMoment(tab: OpenTab, watch: Watch): MomentWords {
  useSignal(watch.journalVersion);
  useSignal(watch.playhead);
  useSignal(timeScale);
  useSignal(tab.session.version);
  const index = shownIndex(watch);
  const { window } = watch;
  const playhead = watch.playhead.peek();
  if (playhead !== null && window.base !== null && !window.covers(playhead)) {
    return { index, when: "", what: "Loading the events around this moment" };
  }
  const entry = window.at(index);
  if (!entry) return { index, when: "", what: "Nothing has happened yet" };
  const when = runTime(watch, entry.t_ns);
  return { index, when, what: happenedInWords(entry, namesOf(tab.session)) };
}
