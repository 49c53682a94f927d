/** One watched value of one run, as its parts are given it. */

import type { Watch } from "../../store/history/run.ts";
import type { ValueHistory } from "../../store/run/value_history.ts";

export interface ShownValue {
  /** What is watched, in words. */
  readonly name: string;
  readonly watch: Watch;
  readonly history: ValueHistory;
}
