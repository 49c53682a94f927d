/** Breakpoints, forced outcomes and preemption. */

import type { Breakpoint } from "../model/generated/protocol.ts";
import { outcomesOf } from "../model/machine.ts";
import type { Forced } from "../store/page/command_arguments.ts";
import { type Active, activeStates } from "../store/run/active.ts";
import {
  breakpointsOf,
  freshId,
  keptBreakpoints,
  newBreakpoint,
  withBreakpoint,
} from "../store/run/breakpoints.ts";
import { liveRun } from "../store/run/running.ts";
import type { CommandChoice, CommandContext, UserCommand } from "./command.ts";
import { cannotCommand, lacks, NO_STATE, pathFor, robotRefuses } from "./run_rules.ts";
import { sendCommand } from "./send_command.ts";
import { anyOnlyState } from "./subject.ts";

export const RUN_POINTS: readonly UserCommand[] = [
  {
    id: "run.breakpoint",
    title: "Breakpoint",
    detail: "Sets a breakpoint before the selected state, or removes its breakpoints.",
    keys: ["Ctrl+F9"],
    menu: "Run/5",
    checked: (context) => pointsAt(context, anyOnlyState(context)?.path ?? null).length > 0,
    refusal: (context, argument) =>
      pathFor(context, argument) === null ? NO_STATE : cannotSetBreakpoints(context),
    run: toggle,
  },
  {
    id: "run.edit-breakpoint",
    title: "Edit breakpoint…",
    detail: "Sets a condition, a hit count, and whether the branch or the whole run pauses.",
    menu: "Run/5",
    refusal: (context, argument) => {
      const isMeant = typeof argument === "object" || pathFor(context, argument) !== null;
      return isMeant ? cannotSetBreakpoints(context) : NO_STATE;
    },
    run: editBreakpoint,
  },
  {
    id: "run.clear-breakpoints",
    title: "Remove all breakpoints",
    menu: "Run/5",
    refusal: (context) => {
      const hasSome = context.tab !== null && breakpointsOf(context.tab).length > 0;
      return hasSome ? cannotSetBreakpoints(context) : "there are no breakpoints";
    },
    run: async (context) => {
      for (const { id } of context.tab ? breakpointsOf(context.tab) : []) {
        await removeBreakpoint(context, id);
      }
    },
  },
  {
    id: "run.force-outcome",
    title: "Force outcome",
    detail:
      "Ends a paused or waiting state with an outcome, or skips the state the run is paused before.",
    menu: "Run/4/Selected state",
    refusal: (context, argument) =>
      cannotCommand(context) ??
      (!argument && forcible(context) === null
        ? "select a state that is paused, waiting, or next"
        : null),
    choices: outcomeChoices,
    run: (context, argument) => {
      if (!argument) return;
      const { path, outcome } = argument;
      return sendCommand(context, "Force outcome", { type: "force_outcome", path, outcome });
    },
  },
  {
    id: "run.preempt",
    title: "Preempt state",
    detail: "Asks the selected active state and everything in it to end.",
    menu: "Run/4/Selected state",
    refusal: (context, argument) => {
      const wanted = pathFor(context, argument);
      const isForcible = active(context).some(({ path }) => path === wanted);
      return cannotCommand(context) ?? (isForcible ? null : "select an active state");
    },
    run: async (context, argument) => {
      const path = pathFor(context, argument);
      if (path !== null) await sendCommand(context, "Preempt state", { type: "preempt", path });
    },
  },
];

/** Reason why breakpoints cannot be set. Those for the next start are stored in this browser. */
export function cannotSetBreakpoints(context: CommandContext): string | null {
  if (!context.tab) return "open a machine first";
  return liveRun(context.tab) ? cannotCommand(context) : null;
}

/** Reason why conditions cannot be set. */
export function cannotSetConditions({ page, tab }: CommandContext): string | null {
  if (lacks(page, "edit") !== null) {
    return "a condition is Python code, which only engineers and admins may add to a run";
  }
  const watch = liveRun(tab);
  return watch ? robotRefuses(watch, "edit") : null;
}

/** Sets it in the active run and for the next start. */
export async function setBreakpoint(
  context: CommandContext,
  breakpoint: Breakpoint,
): Promise<boolean> {
  const { tab } = context;
  if (!tab) return false;
  const runCommand = { type: "set_breakpoint", breakpoint } as const;
  if (liveRun(tab) && !(await sendCommand(context, "Breakpoint", runCommand))) return false;
  const kept = keptBreakpoints(tab);
  kept.value = withBreakpoint(kept.peek(), breakpoint);
  return true;
}

export async function removeBreakpoint(context: CommandContext, id: number): Promise<boolean> {
  const { tab } = context;
  if (!tab) return false;
  if (
    liveRun(tab) &&
    !(await sendCommand(context, "Breakpoint", { type: "remove_breakpoint", id }))
  ) {
    return false;
  }
  const kept = keptBreakpoints(tab);
  kept.value = kept.peek().filter((each) => each.id !== id);
  return true;
}

function pointsAt({ tab }: CommandContext, path: string | null): readonly Breakpoint[] {
  return tab ? breakpointsOf(tab).filter((each) => each.path === path) : [];
}

async function toggle(context: CommandContext, argument?: string): Promise<void> {
  const path = pathFor(context, argument);
  if (path === null || !context.tab) return;
  const there = pointsAt(context, path);
  for (const { id } of there) await removeBreakpoint(context, id);
  if (there.length === 0) await setBreakpoint(context, newBreakpoint(freshId(context.tab), path));
}

/** The argument is an existing breakpoint, or the path of a state for a new one. */
async function editBreakpoint(
  context: CommandContext,
  argument?: Breakpoint | string,
): Promise<void> {
  const { tab, shell } = context;
  if (!tab) return;
  const given = typeof argument === "object" ? argument : null;
  const state = typeof argument === "object" ? argument.path : argument;
  const path = pathFor(context, state) ?? tab.session.machine.root;
  const [there] = pointsAt(context, path);
  const asks = given ?? there ?? newBreakpoint(freshId(tab), path);
  const wanted = await shell.dialog("breakpoint", asks);
  if (wanted) await setBreakpoint(context, wanted);
}

function active({ tab }: CommandContext): readonly Active[] {
  const watch = tab?.run.value;
  return watch && watch.playhead.value === null ? activeStates(watch) : [];
}

/** The selected state, if somebody may choose its outcome. */
function forcible(context: CommandContext): string | null {
  const path = anyOnlyState(context)?.path ?? null;
  const isForcible = active(context).some(
    (state) =>
      (state.path === path && state.phase !== "running" && state.phase !== "preempted") ||
      state.held.some(({ next }) => next === path),
  );
  return isForcible ? path : null;
}

function outcomeChoices(context: CommandContext): readonly CommandChoice<Forced>[] {
  const path = forcible(context);
  const state = path === null ? undefined : context.tab?.session.machine.state(path);
  if (path === null || !state) return [];
  return outcomesOf(state).map(({ id, name }) => ({
    title: name,
    argument: { path, outcome: id },
  }));
}
