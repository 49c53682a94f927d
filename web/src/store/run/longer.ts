/** Which branches of a run are in a state for longer than they ever were. */

import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import { activeStates, lanes } from "./active.ts";
import {
  type Baseline,
  baselineOf,
  earlierRuns,
  isLongerThanEver,
  pastBaselines,
} from "./baseline.ts";
import { sinceSnapshot } from "./since_snapshot.ts";

export interface Longer {
  readonly path: string;
  /** So long it has been there. */
  readonly since_ms: number;
  readonly baseline: Baseline;
}

/** Of a run that is heard, and shown as it is now. A signal's reader, told once a second. */
export function longerThanEver(page: Page, watch: Watch): readonly Longer[] {
  const now = watch.now.value;
  if (now?.run.phase !== "live" || now.link !== "up" || watch.playhead.value !== null) return [];
  const sinceSnapshot_ms = sinceSnapshot(page, watch);
  const past = pastBaselines(page, earlierRuns(page, watch)[0]?.id ?? null).value;
  return lanes(activeStates(watch)).flatMap((lane) => {
    const baseline = baselineOf(watch, past, lane.path);
    const since_ms = lane.since_ms + sinceSnapshot_ms;
    const isLonger = baseline !== null && isLongerThanEver(lane, baseline, since_ms);
    return isLonger ? [{ path: lane.path, since_ms, baseline }] : [];
  });
}
