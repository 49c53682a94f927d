/** Makes of a mission one that never ends, and whose states take turns: so many of them change in a second, however many branches
 * there are. Changes its files. */

import { readdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";

interface Transition {
  readonly from_state: string | null;
  readonly to_state: string;
  readonly to_outcome: number | null;
}

/** So many entries and ends come with each turn of a script: its own two, and those of the states around it. */
const CHANGES_A_TURN = 2.4;

/** Lets the mission in the folder begin again instead of ending, and its scripts wait for their turns. */
export function makeEndless(folder: string, changesPerSecond: number): void {
  const file = join(folder, "core_data.json");
  const root = JSON.parse(readFileSync(file, "utf8"));
  const transitions: Transition[] = Object.values(root.transitions);
  const start = transitions.find(({ from_state }) => from_state === null)?.to_state;
  if (start === undefined) throw new Error(`${file} has no start`);
  const turned = Object.entries<Transition>(root.transitions).map(([id, transition]) => [
    id,
    transition.to_state === root.state_id
      ? { ...transition, to_state: start, to_outcome: null }
      : transition,
  ]);
  writeFileSync(file, JSON.stringify({ ...root, transitions: Object.fromEntries(turned) }));
  pace(folder, CHANGES_A_TURN / changesPerSecond);
}

function pace(folder: string, seconds: number): void {
  for (const name of readdirSync(folder)) {
    const path = join(folder, name);
    if (statSync(path).isDirectory()) pace(path, seconds);
    else if (name === "script.py")
      writeFileSync(path, inTurns(readFileSync(path, "utf8"), seconds));
  }
}

/** The script, which first waits for its turn: one comes after the other, whichever branch they are of. */
function inTurns(script: string, seconds: number): string {
  return `${script}

import sys
import threading
import time

turns = sys.__dict__.setdefault("turns_of_the_bench", {"lock": threading.Lock(), "next": 0.0})
work = execute


def execute(self, inputs, outputs, gvm):
    with turns["lock"]:
        now = time.monotonic()
        turn = max(turns["next"], now)
        turns["next"] = turn + ${seconds}
    if self.preemptive_wait(turn - now):
        return "preempted"
    return work(self, inputs, outputs, gvm)
`;
}
