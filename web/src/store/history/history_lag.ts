/** Backlog of a run's history: recorded events that the page has not received. */

import type { Watch } from "./run.ts";

/** Number of missing events. Reads signals. */
export function historyLag(watch: Watch): number {
  watch.journalVersion.value;
  const now = watch.now.value;
  const written = Math.max(now?.snapshot?.disk_safe ?? 0, now?.run.events ?? 0);
  return Math.max(0, written - (watch.journal.next - 1));
}
