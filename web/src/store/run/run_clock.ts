/** Elapsed time of a run: from its latest snapshot, plus the time since then. */

import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";

/** Time of the shown snapshot by this browser's clock; null before the first. */
export function snapshotAt(page: Pick<Page, "server">, watch: Pick<Watch, "now">): number | null {
  const snapshot_ms = watch.now.value?.snapshot_ms ?? null;
  return snapshot_ms === null ? null : snapshot_ms - (page.server.pulse.value?.ahead_ms ?? 0);
}

/** Elapsed time in ms, whatever moment is shown. For a run that is over, its length. For a live run it is extrapolated from the
 * latest snapshot. */
export function elapsedNow(
  page: Pick<Page, "server">,
  watch: Pick<Watch, "now">,
  now_ms: number,
): number {
  const now = watch.now.value;
  if (!now) return 0;
  const { run, snapshot } = now;
  const snapshotAt_ms = snapshotAt(page, watch);
  if (run.phase !== "live" || !snapshot || snapshotAt_ms === null) return run.length_ms;
  return snapshot.elapsed_ms + Math.max(0, now_ms - snapshotAt_ms);
}
