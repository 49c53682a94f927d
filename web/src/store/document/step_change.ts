/** What a step changed: the states that it touched as they were before and after, with those around them for their names. */

import type { StateDocument } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import { lineage } from "../../model/path.ts";
import { machineOf } from "../../model/plain.ts";
import type { Earlier } from "./states.ts";

export interface StepChange {
  readonly before: Machine;
  readonly after: Machine;
}

/** Names of so many children of a container are kept. */
const CHILDREN_MAX = 300;
/** So many steps are remembered. */
const CHANGES_MAX = 200;

/** The change from what stood there earlier, and of the machine as it is now. */
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

/** Step changes by revision; the oldest are given up. */
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
