/** A watched value of a run, as input of its components. */

import type { Watch } from "../../store/history/run.ts";
import type { ValueHistory } from "../../store/run/value_history.ts";

export interface ShownValue {
  /** Watched value or expression, as text. */
  readonly name: string;
  readonly watch: Watch;
  readonly history: ValueHistory;
}
