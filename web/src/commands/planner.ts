/** Planning for the machine in front: the panel, and taking an answer into the machine. */

import { isWithin, parentOf } from "../model/path.ts";
import { machineOf as machineOfDocument } from "../model/plain_machine.ts";
import { acceptPlan } from "../plan/accept_plan.ts";
import { isRefused } from "../plan/plan.ts";
import type { OpenTab } from "../store/page/page.ts";
import type { GhostMachine } from "../store/page/view.ts";
import type { Planner, Taken } from "../store/planner/planner.ts";
import type { CommandContext, UserCommand } from "./command.ts";
import { performIn } from "./perform.ts";
import { canEdit, placeForNew } from "./subject.ts";

export const PLANNER: readonly UserCommand[] = [
  {
    id: "planner.show",
    title: "Plan…",
    detail: "Plans a sequence of library skills that reaches a goal.",
    menu: "Insert/2",
    enabled: canEdit,
    run: ({ shell }) => shell.showPanel("planner"),
  },
];

/** The container that an answer would go into: what is selected if it takes states, else the outermost one. An answer does not go
 * into one that was taken before, but beside it. */
export function containerForPlan(context: CommandContext, taken: Taken | null): string {
  const chosen = placeForNew({ ...context, canvas: null })?.path;
  const isInTaken = chosen !== undefined && taken !== null && isWithin(chosen, taken.path);
  const container = isInTaken ? parentOf(taken.path) : chosen;
  return container ?? context.tab?.session.machine.root ?? "";
}

/** True if the plan is part of the machine; undo removes it. Reads signals. */
export function isTaken({ session }: Pick<OpenTab, "session">, planner: Planner): boolean {
  session.version.value;
  const taken = planner.taken.value;
  const isAnswer = taken !== null && taken.found === planner.found.value;
  return isAnswer && session.machine.state(taken.path) !== undefined;
}

/** The offered plan as a part of the machine, or the reason why it does not fit. */
export function ghostOf({ session }: OpenTab, planner: Planner): GhostMachine | string | null {
  const found = planner.found.value;
  session.version.value;
  if (!found || isTaken({ session }, planner)) return null;
  const { machine } = session;
  const container = containerOf(machine.root, planner, (path) => machine.state(path) !== undefined);
  const accepted = acceptPlan(machine, container, found.machine);
  if (isRefused(accepted)) return accepted.refused;
  const { states } = accepted;
  const offered = machineOfDocument({ header: { creation_time: "" }, states: [...states] });
  return { container, machine: offered, chosen: null };
}

function containerOf(root: string, planner: Planner, isThere: (path: string) => boolean): string {
  const wanted = planner.container.value;
  return wanted !== null && isThere(wanted) ? wanted : root;
}

/** Makes the answer a part of the machine. */
export async function accept(
  { page }: CommandContext,
  tab: OpenTab,
  planner: Planner,
): Promise<void> {
  const found = planner.found.peek();
  if (!found) return;
  const { machine } = tab.session;
  const container = containerOf(machine.root, planner, (path) => machine.state(path) !== undefined);
  const planned = acceptPlan(machine, container, found.machine);
  const before = planner.taken.peek();
  if (!isRefused(planned)) planner.taken.value = { found, path: planned.path };
  const isDone = await performIn(page, tab, planned);
  if (!isDone) planner.taken.value = before;
}
