/** A machine with an edit upon it that is not made: what a gesture shows while it goes on. It is predicted as an edit that waits for
 * its answer is; never written anywhere. */

import type { Edit, StateDocument } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import { predictedWrites } from "./predict/predict.ts";

export interface ProvisionalMachine {
  readonly machine: Machine;
  /** Paths of the states that are different. */
  readonly touched: Iterable<string>;
}

/** The machine as the edit would make it; null if that is not known, or if states would come or go. */
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
