/** Run from, to and only the selected state, in the current run or in a new one. */

import type { Command as RunCommand, StartRun } from "../model/generated/protocol.ts";
import { liveRun } from "../store/run/running.ts";
import type { CommandContext, UserCommand } from "./command.ts";
import { cannotCommand, cannotStart, NO_STATE, pathFor } from "./run_rules.ts";
import { startRun } from "./run_start.ts";
import { sendCommand, sendCommandTo } from "./send_command.ts";

export const RUN_PLACE: readonly UserCommand[] = [
  {
    id: "run.start-here",
    title: "Start here",
    detail: "Starts at the selected state. Data from earlier states is missing.",
    keys: ["Ctrl+Alt+R"],
    classic: ["Ctrl+R", "Ctrl+Alt+R"],
    menu: "Run/4/Selected state",
    refusal: cannotPlace,
    run: async (context, argument) => {
      const path = pathFor(context, argument);
      if (path === null) return;
      const runCommand: RunCommand = { type: "start", from: path, data: [] };
      if (liveRun(context.tab)) await sendCommand(context, "Start here", runCommand);
      else await startRun(context, { start_from: path });
    },
  },
  {
    id: "run.stop-here",
    title: "Run to here",
    detail: "Runs to the selected state and pauses before it.",
    keys: ["Ctrl+Shift+Alt+R"],
    classic: ["Ctrl+Shift+R", "Ctrl+Shift+Alt+R"],
    menu: "Run/4/Selected state",
    refusal: cannotPlace,
    run: async (context, argument) => {
      const path = pathFor(context, argument);
      if (path === null) return;
      const watch = liveRun(context.tab) ?? (await startRun(context, { hold: true }));
      if (watch) await sendCommandTo(context, watch, "Run to here", { type: "run_to", path });
    },
  },
  state(
    { id: "run.selected", type: "run_selected", afterwards: "hold" },
    "Run this state",
    "Starts at the selected state, runs it, and pauses.",
    ["Ctrl+Alt+I", "Ctrl+Shift+I"],
  ),
  state(
    { id: "run.only-selected", type: "run_only_selected", afterwards: "stop" },
    "Run this state only",
    "Starts at the selected state, runs it, and stops.",
    ["Ctrl+Alt+K", "Ctrl+Shift+K"],
  ),
];

interface StateCommand {
  readonly id: "run.selected" | "run.only-selected";
  /** The command for an active run. */
  readonly type: "run_selected" | "run_only_selected";
  /** Action of a new run after the state. */
  readonly afterwards: StartRun["afterwards"];
}

function state(
  { id, type: runCommand, afterwards }: StateCommand,
  title: string,
  detail: string,
  [key = "", classic = ""]: readonly string[],
): UserCommand {
  return {
    id,
    title,
    detail,
    keys: [key],
    classic: [classic, key],
    menu: "Run/4/Selected state",
    refusal: cannotPlace,
    run: async (context, argument) => {
      const path = pathFor(context, argument);
      if (path === null) return;
      const watch = liveRun(context.tab);
      if (watch) await sendCommandTo(context, watch, title, { type: runCommand, path, data: [] });
      else await startRun(context, { start_from: path, afterwards });
    },
  };
}

function cannotPlace(context: CommandContext, argument?: string): string | null {
  if (pathFor(context, argument) === null) return NO_STATE;
  return liveRun(context.tab) ? cannotCommand(context) : cannotStart(context);
}
