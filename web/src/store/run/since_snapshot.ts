/** How much later it is than what is shown of a run was said, for times that go on: nothing is reckoned on from what may be old, or
 * past. */

import type { RunNow } from "../../model/generated/protocol.ts";
import type { Watch } from "../history/run.ts";
import { clock1s } from "../page/clock1s.ts";
import type { Page } from "../page/page.ts";
import { confirmedUntil, runAge } from "./age.ts";
import { saidAt } from "./run_clock.ts";

/** In ms; another number once a second. A signal's reader. */
export function sinceSnapshot(page: Page, watch: Watch): number {
  const now_ms = clock1s.value;
  const said_ms = saidAt(page, watch);
  const age = runAge(page, watch, now_ms);
  const now = watch.now.value;
  if (age.why === null && now?.run.phase === "crashed") return untilCrash(now);
  if (age.why !== null || said_ms === null || now?.run.phase !== "live") return 0;
  return Math.max(0, now_ms - said_ms);
}

/** The part of that time in which the run was received: alarms go by it, because silence is no proof. A signal's reader. */
export function confirmedSinceSnapshot(page: Page, watch: Watch): number {
  const since_ms = sinceSnapshot(page, watch);
  const snapshot_ms = watch.now.value?.snapshot_ms ?? null;
  const until_ms = confirmedUntil(page, watch);
  if (since_ms === 0 || snapshot_ms === null || until_ms === null) return 0;
  return Math.min(since_ms, Math.max(0, until_ms - snapshot_ms));
}

/** From what the runner said last until it died. */
function untilCrash({ run, snapshot }: RunNow): number {
  return snapshot ? Math.max(0, run.length_ms - snapshot.elapsed_ms) : 0;
}
