/** Makes of a mission one that asks a human: whether a waypoint that cannot be reached is left out. Changes one of its scripts. */

import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

/** The state that asks, by the names around it. */
export const ASKER = [
  "Explore",
  "Survey",
  "Sector 2",
  "Visit the waypoints",
  "Waypoint 12",
  "Leave it out",
] as const;

/** So long there is time to answer, in s. */
const TIME_S = 90;

/** Lets the state ask before it does its work. */
export function makeAsking(mission: string): void {
  const folder = ASKER.reduce((around, name) => join(around, folderOf(around, name)), mission);
  const file = join(folder, "script.py");
  writeFileSync(file, `${readFileSync(file, "utf8")}${QUESTION}`);
}

function folderOf(around: string, name: string): string {
  const start = `${name.replaceAll(" ", "_")}_`;
  const found = readdirSync(around).find((folder) => folder.startsWith(start));
  if (found === undefined) throw new Error(`there is no state ${name} in ${around}`);
  return found;
}

const QUESTION = `

from rafcon import dialog

work = execute


def execute(self, inputs, outputs, gvm):
    question = "Waypoint %d cannot be reached: %s. Is it to be left out?"
    buttons = ["Leave it out", "End the survey"]
    words = question % (inputs["waypoint"], inputs.get("error"))
    pressed = dialog.ask(words, buttons, timeout=${TIME_S}, default="Leave it out")
    return work(self, inputs, outputs, gvm) if pressed.button == 0 else "aborted"
`;
