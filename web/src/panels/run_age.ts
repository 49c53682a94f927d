/** Age of the displayed data of a run, for components. It updates at most once per second, and only while it matters. */

import { computed } from "@preact/signals-core";
import { useMemo } from "react";
import type { Watch } from "../store/history/run.ts";
import { clock1s } from "../store/page/clock1s.ts";
import { type Page, runOf } from "../store/page/page.ts";
import { type RunAge, runAge } from "../store/run/age.ts";
import { useSignal } from "../ui/signals.ts";

const FRESH: RunAge = { age_ms: 0, isOld: false, why: null };

/** Age of a run's data. Without a run it is fresh. */
export function useRunAge(page: Page, watch: Watch | null): RunAge {
  const age = useMemo(() => {
    let before = FRESH;
    return computed(() => {
      const next = watch ? runAge(page, watch, clock1s.value) : FRESH;
      const isSame = next.why === before.why && next.age_ms === before.age_ms;
      before = isSame ? before : next;
      return before;
    });
  }, [page, watch]);
  return useSignal(age);
}

/** True if the data of the current run may be outdated. Elements that show it have the class `shows-run`, and are greyed out then. */
export function useIsOld(page: Page): boolean {
  return useSignal(useMemo(() => oldSignal(page), [page]));
}

/** Signal for `useIsOld`. */
function oldSignal(page: Page) {
  return computed(() => {
    const watch = runOf(page);
    return watch !== null && runAge(page, watch, clock1s.value).isOld;
  });
}
