/** How old what is shown of a run may be, and why. Times of the server count by its own clock, however wrong this browser's is. */

import type { RunNow } from "../../model/generated/protocol.ts";
import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import type { ServerPulse } from "../page/server.ts";

export interface RunAge {
  /** So long ago it was true for sure. */
  readonly age_ms: number;
  /** Whether something else may be true by now; what is shown of the run is greyed then. */
  readonly isOld: boolean;
  /** `link`: the server is not heard. `runner`: the server has lost the run's program. `silence`: it does not answer the server.
   * `blackout`: the station does not hear the robot.
   * `engine`: it answers, but its engine takes no inputs.
   * `moment`: a past moment is shown, which is what the user wants, and never old. */
  readonly why: "link" | "runner" | "silence" | "blackout" | "engine" | "moment" | null;
}

const WHY: { readonly [link: string]: RunAge["why"] } = { silent: "silence", stuck: "engine" };

const FRESH: RunAge = { age_ms: 0, isOld: false, why: null };

/** Reads signals: an effect or computed value is told when it may be another. */
export function runAge(page: Pick<Page, "server">, watch: Watch, now_ms: number): RunAge {
  if (watch.playhead.value !== null) return momentAge(watch);
  return truthAge(page, watch, now_ms);
}

/** The same of the latest truth about the run, whatever moment is shown. */
export function truthAge(page: Pick<Page, "server">, watch: Watch, now_ms: number): RunAge {
  const now = watch.now.value;
  if (!now || !isGoingOn(now)) return FRESH;
  const [link, pulse] = [page.server.link.value, page.server.pulse.value];
  const age_ms = pictureAge(watch, pulse, now_ms);
  const isLost = link.state !== "up" || !watch.isCurrent.value || age_ms >= (pulse?.old_ms ?? 0);
  if (isLost && pulse) return { age_ms, isOld: true, why: "link" };
  if (now.link === "up") return FRESH;
  const isFarAway = now.robot != null;
  const why = isFarAway && now.link === "silent" ? "blackout" : (WHY[now.link] ?? "runner");
  return { age_ms: runnerAge(now, pulse, now_ms), isOld: true, why };
}

/** Whether the run goes on, as far as it is known; else nothing about it will be another. */
export function isGoingOn(now: RunNow): boolean {
  return now.run.phase === "live" || now.run.phase === "starting";
}

/** Since what is shown was true for sure. By the server's clock: what was held back on the way is no younger for that. */
function pictureAge(watch: Watch, pulse: ServerPulse | null, now_ms: number): number {
  const there_ms = now_ms + (pulse?.ahead_ms ?? 0);
  return Math.max(0, there_ms - (confirmedAt(watch, pulse) ?? there_ms));
}

/** The server's time until which what is shown of the run is confirmed; null before anything is. */
function confirmedAt(watch: Watch, pulse: ServerPulse | null): number | null {
  const heard_ms = watch.isCurrent.value ? (pulse?.server_ms ?? 0) : 0;
  const proven_ms = watch.proven_ms.value;
  return proven_ms === null ? null : Math.max(heard_ms, proven_ms);
}

/** The server's time until which the run is confirmed, in ms: silence confirms nothing, neither of the server nor of a robot. Null
 * before anything is confirmed. A signal's reader. */
export function confirmedUntil(page: Pick<Page, "server">, watch: Watch): number | null {
  const until_ms = confirmedAt(watch, page.server.pulse.value);
  const robot_ms = watch.now.value?.robot?.heard_ms ?? null;
  return until_ms === null || robot_ms === null ? until_ms : Math.min(until_ms, robot_ms);
}

/** Since the server heard the runner, by the server's clock. */
function runnerAge(now: RunNow, pulse: ServerPulse | null, now_ms: number): number {
  const there_ms = now_ms + (pulse?.ahead_ms ?? 0);
  return Math.max(0, there_ms - (now.runner_heard_ms ?? now.run.started_ms));
}

/** From the moment to the end of what was told. */
function momentAge(watch: Watch): RunAge {
  const { journal } = watch;
  watch.journalVersion.value;
  const end_ns = journal.length === 0 ? 0 : journal.t_ns(journal.length - 1);
  const playhead = watch.playhead.value ?? 0;
  const t_ns = watch.window.t_ns(watch.window.indexOf(playhead));
  return { age_ms: Math.max(0, (end_ns - t_ns) / 1e6), isOld: false, why: "moment" };
}
