/** The moment of a run that the page shows, in words. */

import { shownIndex } from "../../store/history/moments.ts";
import type { Watch } from "../../store/history/run.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { runTime, timeScale } from "../../store/page/times.ts";
import { useSignal } from "../../ui/signals.ts";
import { happenedInWords, namesOf } from "./happened.ts";

interface MomentWords {
  /** Its place in the journal. */
  readonly index: number;
  /** On the scale of the settings. */
  readonly when: string;
  /** The event. */
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
  const happening = window.at(index);
  if (!happening) return { index, when: "", what: "Nothing has happened yet" };
  const when = runTime(watch, happening.t_ns);
  return { index, when, what: happenedInWords(happening, namesOf(tab.session)) };
}
