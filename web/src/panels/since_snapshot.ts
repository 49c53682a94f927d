/** How much later it is than what is shown of a run was said, for components whose times go on. */

import type { Watch } from "../store/history/run.ts";
import { sinceSnapshot } from "../store/run/since_snapshot.ts";
import { useComputed } from "../ui/signals.ts";
import { useHost } from "./context.tsx";

export function useSinceSnapshot(watch: Watch): number {
  const { page } = useHost().context();
  return useComputed(() => sinceSnapshot(page, watch), [page, watch]);
}
