/** How long a run has gone on: by the latest truth, and by the time since that was said. */

import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";

/** When the runner said what is shown, by this browser's clock; null before it said anything. */
export function saidAt(page: Pick<Page, "server">, watch: Pick<Watch, "now">): number | null {
  const said_ms = watch.now.value?.snapshot_ms ?? null;
  return said_ms === null ? null : said_ms - (page.server.pulse.value?.ahead_ms ?? 0);
}

/** The time since the start, in ms, whatever moment is shown; of a run that is over its length. While the run goes on it is
 * reckoned on from what the runner said last. */
export function elapsedNow(
  page: Pick<Page, "server">,
  watch: Pick<Watch, "now">,
  now_ms: number,
): number {
  const now = watch.now.value;
  if (!now) return 0;
  const { run, snapshot } = now;
  const said_ms = saidAt(page, watch);
  if (run.phase !== "live" || !snapshot || said_ms === null) return run.length_ms;
  return snapshot.elapsed_ms + Math.max(0, now_ms - said_ms);
}
