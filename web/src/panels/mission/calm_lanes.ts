/** The branches of a run at a pace that people can read: at once where one is in another phase, else about once a second. */

import { computed } from "@preact/signals-core";
import { useMemo } from "react";
import type { Watch } from "../../store/history/run.ts";
import type { Page } from "../../store/page/page.ts";
import { type Active, activeStates, lanes } from "../../store/run/active.ts";
import { confirmedSinceSnapshot, sinceSnapshot } from "../../store/run/since_snapshot.ts";
import { isSameList, useComputed } from "../../ui/signals.ts";
import { useThrottled } from "../../ui/throttled.ts";
import { inOrder } from "../parts/branch.ts";

/** A little less than a second, so that each second is told. */
const PACE_MS = 900;

interface CalmLanes {
  /** Those that want somebody first. */
  readonly all: readonly Active[];
  /** So much longer they have gone on by then than they say, in ms. */
  readonly sinceSnapshot_ms: number;
  /** The part of it in which the run was received. */
  readonly confirmed_ms: number;
}

export function useCalmLanes(page: Page, watch: Watch): CalmLanes {
  const phases = useComputed(() => phasesOf(watch), [watch], isSameList);
  // biome-ignore lint/correctness/useExhaustiveDependencies: other phases are told at once, as another signal is
  const told = useMemo(
    () =>
      computed(() => ({
        all: inOrder(lanes(activeStates(watch))),
        sinceSnapshot_ms: sinceSnapshot(page, watch),
        confirmed_ms: confirmedSinceSnapshot(page, watch),
      })),
    [page, watch, phases],
  );
  return useThrottled(told, PACE_MS);
}

/** In which phase each branch is, and at which moment: another list is told at once. */
function phasesOf(watch: Watch): readonly unknown[] {
  const all = lanes(activeStates(watch)).map(({ branch, phase }) => `${branch} ${phase}`);
  return [watch.playhead.value, ...all.sort()];
}
