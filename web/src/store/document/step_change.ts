/** Change of a step: the affected states before and after it, with the states around them for their names. */

import type { StateDocument } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import { lineage } from "../../model/path.ts";
import { machineOf } from "../../model/plain_machine.ts";
import type { Earlier } from "./states.ts";

export interface StepChange {
  readonly before: Machine;
  readonly after: Machine;
}

/** Greatest number of children per container that are kept for their names. */
const CHILDREN_MAX = 300;
/** Capacity of the step changes. */
const CHANGES_MAX = 200;

/** Change from the earlier states to the current machine. */
export function stepChangeOf(earlier: Earlier, now: Machine): StepChange {
  const paths = new Set<string>();
  for (const path of earlier.keys()) {
    for (const outer of lineage(path)) paths.add(outer);
    if (now.state(path)?.library) continue;
    for (const child of now.children(path).slice(0, CHILDREN_MAX)) paths.add(child);
  }
  const inOrder = [...paths].sort((one, other) => one.length - other.length);
  const machine = (state: (path: string) => StateDocument | undefined) =>
    machineOf({ header: now.header, states: inOrder.flatMap((path) => state(path) ?? []) });
  return {
    before: machine((path) => (earlier.has(path) ? earlier.get(path) : now.state(path))),
    after: machine((path) => now.state(path)),
  };
}

/** Step changes by revision. The oldest are dropped. */
export class StepChanges {
  readonly #changes = new Map<number, StepChange>();

  get(revision: number): StepChange | undefined {
    return this.#changes.get(revision);
  }

  put(revision: number, stepChange: StepChange): void {
    this.#changes.set(revision, stepChange);
    for (const oldest of this.#changes.keys()) {
      if (this.#changes.size <= CHANGES_MAX) break;
      this.#changes.delete(oldest);
    }
  }
}
