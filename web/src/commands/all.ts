/** All commands of the page. */

import { ARRANGE } from "./arrange.ts";
import { Commands } from "./command.ts";
import { EDIT } from "./edit.ts";
import { FILE } from "./file.ts";
import { HELP } from "./help.ts";
import { INSERT } from "./insert.ts";
import { VIEW } from "./view.ts";

export function allCommands(): Commands {
  const commands = new Commands();
  for (const topic of [FILE, EDIT, INSERT, ARRANGE, VIEW, HELP]) commands.add(topic);
  return commands;
}
