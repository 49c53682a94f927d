/** Branches of a run at a readable pace: immediately after a change of phase, otherwise about once per second. */

import { computed } from "@preact/signals-core";
import { useMemo } from "react";
import type { Watch } from "../../store/history/run.ts";
import type { Page } from "../../store/page/page.ts";
import { type Active, activeStates, lanes } from "../../store/run/active.ts";
import { sinceSnapshot } from "../../store/run/data_end.ts";
import { isSameList, useComputed } from "../../ui/signals.ts";
import { useThrottled } from "../../ui/throttled.ts";
import { inOrder } from "../parts/branch.ts";

/** Refresh interval in ms, slightly below a second so that no second is skipped. */
const PACE_MS = 900;

interface CalmLanes {
  /** Branches that need a person come first. */
  readonly all: readonly Active[];
  /** Time from the snapshot with the durations to the end of the data, in ms. */
  readonly sinceSnapshot_ms: number;
}

export function useCalmLanes(page: Page, watch: Watch): CalmLanes {
  const phases = useComputed(() => phasesOf(watch), [watch], isSameList);
  // biome-ignore lint/correctness/useExhaustiveDependencies: a change of phases creates another signal, which is read at once
  const latest = useMemo(
    () =>
      computed(() => ({
        all: inOrder(lanes(activeStates(watch))),
        sinceSnapshot_ms: sinceSnapshot(page, watch),
      })),
    [page, watch, phases],
  );
  return useThrottled(latest, PACE_MS);
}

/** Phases of all branches, and the shown moment. A change of this list is shown at once. */
function phasesOf(watch: Watch): readonly unknown[] {
  const all = lanes(activeStates(watch)).map(({ branch, phase }) => `${branch} ${phase}`);
  return [watch.playhead.value, ...all.sort()];
}
