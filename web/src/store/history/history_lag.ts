/** How much of a run's history is known to be there and was not told yet. */

import type { Watch } from "./run.ts";

/** So many events; reads signals. */
export function historyLag(watch: Watch): number {
  watch.journalVersion.value;
  const now = watch.now.value;
  const written = Math.max(now?.snapshot?.disk_safe ?? 0, now?.run.events ?? 0);
  return Math.max(0, written - (watch.journal.next - 1));
}
