/** Age of an assumed status: an active run without contact may have changed. */

import type { RunSummary } from "../../model/generated/protocol.ts";
import { clock1s } from "../../store/page/clock1s.ts";
import { useComputed } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { agePhrase } from "./age.ts";

/** Such as `as of 4 min 5 s ago`, updated every second; null if the run is received or over. */
export function useAssumed({ unheard_since_ms }: RunSummary): string | null {
  const { page } = useHost().context();
  return useComputed(() => {
    if (unheard_since_ms === undefined) return null;
    const there_ms = clock1s.value + (page.server.pulse.value?.ahead_ms ?? 0);
    return `as of ${agePhrase(there_ms - unheard_since_ms)} ago`;
  }, [page, unheard_since_ms]);
}
