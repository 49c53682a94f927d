/** All commands of the page. */

import { ARRANGE } from "./arrange.ts";
import { Commands } from "./command.ts";
import { CONTROL } from "./control.ts";
import { EDIT } from "./edit.ts";
import { FILE } from "./file.ts";
import { HELP } from "./help.ts";
import { INSERT } from "./insert.ts";
import { MISSION } from "./mission.ts";
import { PLANNER } from "./planner.ts";
import { RUN } from "./run.ts";
import { RUN_AGAIN } from "./run_again.ts";
import { RUN_CRASH } from "./run_crash.ts";
import { RUN_PLACE } from "./run_place.ts";
import { RUN_POINTS } from "./run_points.ts";
import { RUN_SHOW } from "./run_show.ts";
import { RUN_STEP } from "./run_step.ts";
import { RUN_TIME } from "./run_time.ts";
import { VIEW } from "./view.ts";

export function allCommands(): Commands {
  const commands = new Commands();
  const runs = [
    ...RUN,
    ...RUN_AGAIN,
    ...RUN_STEP,
    ...RUN_PLACE,
    ...RUN_POINTS,
    ...RUN_CRASH,
    ...RUN_SHOW,
    ...RUN_TIME,
  ];
  for (const topic of [FILE, EDIT, INSERT, PLANNER, ARRANGE, VIEW, runs, MISSION, CONTROL, HELP])
    commands.add(topic);
  return commands;
}
