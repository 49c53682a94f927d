/** A machine with an edit applied that is not made yet, to show during a gesture. The prediction is that of a pending edit. It is
 * never stored. */

import type { Edit, StateDocument } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import { predictedWrites } from "./predict/predict.ts";

export interface ProvisionalMachine {
  readonly machine: Machine;
  /** Paths of changed states. */
  readonly touched: Iterable<string>;
}

/** The machine after the edit; null if that is unknown, or if states would be added or removed. */
export function provisional(machine: Machine, edit: Edit): ProvisionalMachine | null {
  const states = new Map<string, StateDocument>();
  for (const write of predictedWrites(machine, edit) ?? []) {
    if (!("put" in write) || !machine.state(write.put.path)) return null;
    states.set(write.put.path, write.put);
  }
  const shown: Machine = {
    version: machine.version,
    root: machine.root,
    header: machine.header,
    state: (path) => states.get(path) ?? machine.state(path),
    children: (path) => machine.children(path),
    isInLibrary: (path) => machine.isInLibrary(path),
    paths: () => machine.paths(),
  };
  return { machine: shown, touched: states.keys() };
}
