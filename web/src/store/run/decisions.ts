/** Decisions after a crash: resuming the run, and handling the scripts that it interrupted. */

import type { Watch } from "../history/run.ts";
import { activeStates } from "./active.ts";

/** Number of decisions that a run waits for now. Reads signals. */
export function openDecisions(watch: Watch): number {
  const phase = watch.now.value?.run.phase;
  if (phase === "crashed") return 1;
  if (phase !== "live") return 0;
  return activeStates(watch).filter((state) => state.phase === "interrupted").length;
}
