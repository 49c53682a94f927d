/** Progress of a run. */

import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import { truthAge } from "./age.ts";
import { snapshotAt } from "./run_clock.ts";

/** Elapsed time of a run in ms, whatever moment is shown. For an active run, the time until it was last received; at least the time
 * of its last event. */
export function progressAt(page: Pick<Page, "server">, watch: Watch, now_ms: number): number {
  const { journal, now } = watch;
  const lastEvent_ms = journal.length > 0 ? journal.t_ns(journal.length - 1) / 1e6 : 0;
  const [snapshot, snapshotAt_ms] = [now.value?.snapshot, snapshotAt(page, watch)];
  const isLive = now.value?.run.phase === "live" && now.value.link !== "over";
  if (!isLive || !snapshot || snapshotAt_ms === null) return lastEvent_ms;
  const { age_ms } = truthAge(page, watch, now_ms);
  return Math.max(lastEvent_ms, snapshot.elapsed_ms + Math.max(0, now_ms - age_ms - snapshotAt_ms));
}
