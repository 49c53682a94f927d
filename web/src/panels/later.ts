/** How much later it is than what is shown of a run was said, for components whose times go on. */

import { laterBy } from "../store/later.ts";
import type { Watch } from "../store/run.ts";
import { useComputed } from "../ui/signals.ts";
import { useHost } from "./context.tsx";

export function useLater(watch: Watch): number {
  const { page } = useHost().context();
  return useComputed(() => laterBy(page, watch), [page, watch]);
}
