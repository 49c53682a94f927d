/** Finds the branches of a run that are in a state for longer than ever before. */

import type { Watch } from "../history/run.ts";
import { clock1s } from "../page/clock1s.ts";
import type { Page } from "../page/page.ts";
import { activeStates, lanes } from "./active.ts";
import { runAge } from "./age.ts";
import {
  type Baseline,
  baselineOf,
  earlierRuns,
  isLongerThanEver,
  pastBaselines,
} from "./baseline.ts";
import { isSnapshotOutdated, sinceSnapshot } from "./data_end.ts";

export interface Longer {
  readonly path: string;
  /** Time since its entry. */
  readonly since_ms: number;
  readonly baseline: Baseline;
}

/** Branches of a live run, measured by the time in which the run was received. Null while its state may be old, or the robot has
 * events after it. Reads signals; updated once a second. */
export function longerThanEver(page: Page, watch: Watch): readonly Longer[] | null {
  if (watch.now.value?.run.phase !== "live" || watch.playhead.value !== null) return [];
  if (runAge(page, watch, clock1s.value).isOld || isSnapshotOutdated(watch)) return null;
  const sinceSnapshot_ms = sinceSnapshot(page, watch);
  const past = pastBaselines(page, earlierRuns(page, watch)[0]?.id ?? null).value;
  return lanes(activeStates(watch)).flatMap((lane) => {
    const baseline = baselineOf(watch, past, lane.path);
    const since_ms = lane.since_ms + sinceSnapshot_ms;
    const isLonger = baseline !== null && isLongerThanEver(lane, baseline, since_ms);
    return isLonger ? [{ path: lane.path, since_ms, baseline }] : [];
  });
}
