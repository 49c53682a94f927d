/** Machines without a drawing, such as those created by programs. */

import { readLayout } from "./layout_reader.ts";
import type { Machine } from "./machine.ts";
import { parentOf } from "./path.ts";

/** True if the machine has at least two states below the root, and none of them has a position. */
export function isUndrawn(machine: Machine): boolean {
  let count = 0;
  for (const path of machine.paths()) {
    if (parentOf(path) === null) continue;
    const state = machine.state(path);
    if (state && readLayout(state).position) return false;
    count += 1;
  }
  return count > 1;
}
