/** Makes of a mission one of which pictures can be taken: two states take their time, and one asks a human whether a waypoint that
 * cannot be reached is left out. Changes their scripts. */

import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const SECTOR = ["Explore", "Survey", "Sector 2", "Visit the waypoints"] as const;

/** Its two children take their time, side by side. The names around it, from below the root. */
export const SLOW = [...SECTOR, "Waypoint 10", "Look around"] as const;
const SLOW_CHILDREN = ["Take pictures", "Scan the ground"];
const SLOW_S = 10;

/** The state that asks. */
export const ASKER = "Leave it out";
/** So long there is time to answer, in s. */
const TIME_S = 90;

export function makePosing(mission: string): void {
  for (const child of SLOW_CHILDREN) change(mission, [...SLOW, child], PAUSE);
  change(mission, [...SECTOR, "Waypoint 12", ASKER], QUESTION);
}

/** Puts another `execute` behind the state's own. */
function change(mission: string, names: readonly string[], more: string): void {
  const folder = names.reduce((around, name) => join(around, folderOf(around, name)), mission);
  const file = join(folder, "script.py");
  writeFileSync(file, `${readFileSync(file, "utf8")}${more}`);
}

function folderOf(around: string, name: string): string {
  const start = `${name.replaceAll(" ", "_")}_`;
  const found = readdirSync(around).find((folder) => folder.startsWith(start));
  if (found === undefined) throw new Error(`there is no state ${name} in ${around}`);
  return found;
}

const PAUSE = `

work = execute


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(${SLOW_S}):
        return "preempted"
    return work(self, inputs, outputs, gvm)
`;

const QUESTION = `

from rafcon import dialog

work = execute


def execute(self, inputs, outputs, gvm):
    question = "Waypoint %d cannot be reached: %s. Is it to be left out?"
    buttons = ["${ASKER}", "End the survey"]
    words = question % (inputs["waypoint"], inputs.get("error"))
    pressed = dialog.ask(words, buttons, timeout=${TIME_S}, default="${ASKER}")
    return work(self, inputs, outputs, gvm) if pressed.button == 0 else "aborted"
`;
