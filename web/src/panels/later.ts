/** How much later it is than what is shown of a run was said, for times that go on: nothing is reckoned on from what may be old, or
 * past. */

import { runAge } from "../store/age.ts";
import type { Watch } from "../store/run.ts";
import { saidAt } from "../store/run_clock.ts";
import { seconds } from "../store/seconds.ts";
import { useComputed } from "../ui/signals.ts";
import { useHost } from "./context.tsx";

export function useLater(watch: Watch): number {
  const { page } = useHost().context();
  return useComputed(() => {
    const now_ms = seconds.value;
    const said_ms = saidAt(page, watch);
    const age = runAge(page, watch, now_ms);
    const isOn = watch.now.value?.run.phase === "live";
    if (age.why !== null || said_ms === null || !isOn) return 0;
    return Math.max(0, now_ms - said_ms);
  }, [page, watch]);
}
