/** Age of the shown state of a run, with the reason. Server times use the server's clock, however wrong this browser's clock is. */

import { isLive } from "../../model/run_words.ts";
import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import { isServerSilent, sinceDataEnd } from "./data_end.ts";

export interface RunAge {
  /** Time since the shown state was last confirmed. */
  readonly age_ms: number;
  /** True if the state may have changed since. It is then displayed in grey. */
  readonly isOld: boolean;
  /** `link`: the server is silent.
   * `runner`: the server has lost the run's program.
   * `silence`: the program does not respond to the server.
   * `blackout`: the station receives nothing from the robot.
   * `engine`: the program responds, but its engine takes no inputs.
   * `moment`: the user chose a past moment, which is never old. */
  readonly why: "link" | "runner" | "silence" | "blackout" | "engine" | "moment" | null;
}

const WHY: { readonly [link: string]: RunAge["why"] } = { silent: "silence", stuck: "engine" };

const FRESH: RunAge = { age_ms: 0, isOld: false, why: null };

/** Age of what is shown. Reads signals: an effect or computed value is updated when it changes. */
export function runAge(page: Pick<Page, "server">, watch: Watch, now_ms: number): RunAge {
  if (watch.playhead.value !== null) return momentAge(watch);
  return truthAge(page, watch, now_ms);
}

/** Age of the run's latest status, whatever moment is shown. */
export function truthAge(page: Pick<Page, "server">, watch: Watch, now_ms: number): RunAge {
  const now = watch.now.value;
  if (!now || !isLive(now.run.phase)) return FRESH;
  const [link, pulse] = [page.server.link.value, page.server.pulse.value];
  const age_ms = sinceDataEnd(page, watch, now_ms);
  const isLost =
    link.state !== "up" || !watch.isCurrent.value || isServerSilent(page, watch, now_ms);
  if (isLost && pulse) return { age_ms, isOld: true, why: "link" };
  if (now.link === "up") return FRESH;
  const isFarAway = now.robot != null;
  const why = isFarAway && now.link === "silent" ? "blackout" : (WHY[now.link] ?? "runner");
  return { age_ms, isOld: true, why };
}

/** Age of the shown moment: the time from it to the last received event. */
function momentAge(watch: Watch): RunAge {
  const { journal } = watch;
  watch.journalVersion.value;
  const end_ns = journal.length === 0 ? 0 : journal.t_ns(journal.length - 1);
  const playhead = watch.playhead.value ?? 0;
  const t_ns = watch.window.t_ns(watch.window.indexOf(playhead));
  return { age_ms: Math.max(0, (end_ns - t_ns) / 1e6), isOld: false, why: "moment" };
}
