/** How far a run has come. */

import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import { truthAge } from "./age.ts";
import { saidAt } from "./run_clock.ts";

/** In ms since its start, whatever moment is shown: while it goes on, until it was heard last; at least to its last event. */
export function progressAt(page: Pick<Page, "server">, watch: Watch, now_ms: number): number {
  const { journal, now } = watch;
  const told_ms = journal.length > 0 ? journal.t_ns(journal.length - 1) / 1e6 : 0;
  const [snapshot, said_ms] = [now.value?.snapshot, saidAt(page, watch)];
  const isLive = now.value?.run.phase === "live" && now.value.link !== "over";
  if (!isLive || !snapshot || said_ms === null) return told_ms;
  const { age_ms } = truthAge(page, watch, now_ms);
  return Math.max(told_ms, snapshot.elapsed_ms + Math.max(0, now_ms - age_ms - said_ms));
}
