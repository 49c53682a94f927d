/** Time since the snapshot of a run, for components with growing times. */

import type { Watch } from "../store/history/run.ts";
import { sinceSnapshot } from "../store/run/data_end.ts";
import { useComputed } from "../ui/signals.ts";
import { useHost } from "./context.tsx";

export function useSinceSnapshot(watch: Watch): number {
  const { page } = useHost().context();
  return useComputed(() => sinceSnapshot(page, watch), [page, watch]);
}
