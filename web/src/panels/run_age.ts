/** How old what is shown of a run may be, for components: drawn again once a second at most while that is of interest. */

import { computed } from "@preact/signals-core";
import { useMemo } from "react";
import type { Watch } from "../store/history/run.ts";
import { clock1s } from "../store/page/clock1s.ts";
import { type Page, runOf } from "../store/page/page.ts";
import { type RunAge, runAge } from "../store/run/age.ts";
import { useSignal } from "../ui/signals.ts";

const FRESH: RunAge = { age_ms: 0, isOld: false, why: null };

/** Of one run; of none it is fresh. */
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

/** Whether what is shown of the run in front may be old. What shows it has the class `shows-run`, and is greyed then. */
export function useIsOld(page: Page): boolean {
  return useSignal(useMemo(() => oldSignal(page), [page]));
}

/** The same as a signal. */
function oldSignal(page: Page) {
  return computed(() => {
    const watch = runOf(page);
    return watch !== null && runAge(page, watch, clock1s.value).isOld;
  });
}
