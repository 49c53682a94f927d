/** Runs from, to and of the selected state: of the run in front if it goes on, else of a new one. */

import type { Command as Order } from "../model/generated/protocol.ts";
import { liveRun } from "../store/running.ts";
import type { Command, Context } from "./command.ts";
import { give, giveTo } from "./give.ts";
import { cannotCommand, cannotStart, NO_STATE, pathFor } from "./run_rules.ts";
import { startRun } from "./run_start.ts";

export const RUN_PLACE: readonly Command[] = [
  {
    id: "run.start-here",
    title: "Start here",
    detail: "Begins at the selected state. What states before it would have given is missing.",
    keys: ["Ctrl+Alt+R"],
    classic: ["Ctrl+R", "Ctrl+Alt+R"],
    menu: "Run/4/Selected state",
    refusal: cannotPlace,
    run: async (context, argument) => {
      const path = pathFor(context, argument);
      if (path === null) return;
      const order: Order = { type: "start", from: path, data: [] };
      if (liveRun(context.tab)) await give(context, "Start here", order);
      else await startRun(context, { start_from: path });
    },
  },
  place(
    "run.stop-here",
    "Run to here",
    "Runs until before the selected state, and is held there.",
    ["Ctrl+Shift+Alt+R", "Ctrl+Shift+R"],
  ),
  place("run.selected", "Run this state", "Begins at the selected state, runs it, and is held.", [
    "Ctrl+Alt+I",
    "Ctrl+Shift+I",
  ]),
  place(
    "run.only-selected",
    "Run this state only",
    "Begins at the selected state, runs it, and stops.",
    ["Ctrl+Alt+K", "Ctrl+Shift+K"],
  ),
];

function place(
  id: string,
  title: string,
  detail: string,
  [key = "", classic = ""]: readonly string[],
): Command {
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
      const watch = liveRun(context.tab) ?? (await startRun(context, { hold: true }));
      if (watch) await giveTo(context, watch, title, orderOf(id, path));
    },
  };
}

function orderOf(id: string, path: string): Order {
  if (id === "run.stop-here") return { type: "run_to", path };
  const type = id === "run.selected" ? "run_selected" : "run_only_selected";
  return { type, path, data: [] };
}

function cannotPlace(context: Context, argument?: unknown): string | null {
  if (pathFor(context, argument) === null) return NO_STATE;
  return liveRun(context.tab) ? cannotCommand(context) : cannotStart(context);
}
