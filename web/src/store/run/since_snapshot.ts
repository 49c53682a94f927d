/** Time since the snapshot of a run, to extrapolate running times. Old or past states are not extrapolated. */

import type { RunNow } from "../../model/generated/protocol.ts";
import type { Watch } from "../history/run.ts";
import { clock1s } from "../page/clock1s.ts";
import type { Page } from "../page/page.ts";
import { confirmedUntil, runAge } from "./age.ts";
import { snapshotAt } from "./run_clock.ts";

/** In ms; updated once a second. Reads signals. */
export function sinceSnapshot(page: Page, watch: Watch): number {
  const now_ms = clock1s.value;
  const snapshotAt_ms = snapshotAt(page, watch);
  const age = runAge(page, watch, now_ms);
  const now = watch.now.value;
  if (age.why === null && now?.run.phase === "crashed") return untilCrash(now);
  if (age.why !== null || snapshotAt_ms === null || now?.run.phase !== "live") return 0;
  return Math.max(0, now_ms - snapshotAt_ms);
}

/** The part of that time in which the run was received. Alarms use it, because silence proves nothing. Reads signals. */
export function confirmedSinceSnapshot(page: Page, watch: Watch): number {
  const since_ms = sinceSnapshot(page, watch);
  const snapshot_ms = watch.now.value?.snapshot_ms ?? null;
  const until_ms = confirmedUntil(page, watch);
  if (since_ms === 0 || snapshot_ms === null || until_ms === null) return 0;
  return Math.min(since_ms, Math.max(0, until_ms - snapshot_ms));
}

/** Time from the last snapshot to the crash. */
function untilCrash({ run, snapshot }: RunNow): number {
  return snapshot ? Math.max(0, run.length_ms - snapshot.elapsed_ms) : 0;
}
