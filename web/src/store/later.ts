/** How much later it is than what is shown of a run was said, for times that go on: nothing is reckoned on from what may be old, or
 * past. */

import { runAge } from "./age.ts";
import type { Page } from "./page.ts";
import type { Watch } from "./run.ts";
import { saidAt } from "./run_clock.ts";
import { seconds } from "./seconds.ts";

/** In ms; another number once a second. A signal's reader. */
export function laterBy(page: Page, watch: Watch): number {
  const now_ms = seconds.value;
  const said_ms = saidAt(page, watch);
  const age = runAge(page, watch, now_ms);
  const isOn = watch.now.value?.run.phase === "live";
  if (age.why !== null || said_ms === null || !isOn) return 0;
  return Math.max(0, now_ms - said_ms);
}
