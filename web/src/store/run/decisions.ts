/** What a crash leaves to people: whether, and how, a run is resumed, and what becomes of scripts that it interrupted. */

import type { Watch } from "../history/run.ts";
import { activeStates } from "./active.ts";

/** How many decisions a run waits for now. A signal's reader. */
export function openDecisions(watch: Watch): number {
  const phase = watch.now.value?.run.phase;
  if (phase === "crashed") return 1;
  if (phase !== "live") return 0;
  return activeStates(watch).filter((state) => state.phase === "interrupted").length;
}
