/** Which branches of a run are in a state for longer than they ever were. */

import { activeStates, lanes } from "./active.ts";
import { laterBy } from "./later.ts";
import type { Page } from "./page.ts";
import type { Watch } from "./run.ts";
import { earlierRuns, isLongerThanEver, pastUsual, type Usual, usualOf } from "./usual.ts";

export interface Longer {
  readonly path: string;
  /** So long it has been there. */
  readonly since_ms: number;
  readonly usual: Usual;
}

/** Of a run that is heard, and shown as it is now. A signal's reader, told once a second. */
export function longerThanEver(page: Page, watch: Watch): readonly Longer[] {
  const now = watch.now.value;
  if (now?.run.phase !== "live" || now.link !== "up" || watch.playhead.value !== null) return [];
  const later_ms = laterBy(page, watch);
  const past = pastUsual(page, earlierRuns(page, watch)[0]?.id ?? null).value;
  return lanes(activeStates(watch)).flatMap((lane) => {
    const usual = usualOf(watch, past, lane.path);
    const since_ms = lane.since_ms + later_ms;
    const isLonger = usual !== null && isLongerThanEver(lane, usual, since_ms);
    return isLonger ? [{ path: lane.path, since_ms, usual }] : [];
  });
}
