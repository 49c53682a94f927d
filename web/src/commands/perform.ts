/** Applies the edits of commands to the current machine, and reports refusals. */

import type { Machine } from "../model/machine.ts";
import type { Planned } from "../plan/plan.ts";
import { applyPlan, unshownEdit } from "../store/page/apply_plan.ts";
import type { OpenTab, Page } from "../store/page/page.ts";
import type { CommandContext } from "./command.ts";

/** Applies the edit to the current machine; false if it was refused. An edit that follows one whose result is not visible yet waits
 * for it, and is planned with the selection of that time. */
export async function perform(
  context: CommandContext,
  plan: (machine: Machine) => Planned,
): Promise<boolean> {
  const { page, tab } = context;
  if (!tab) return false;
  for (let edit = unshownEdit(tab.session); edit; edit = unshownEdit(tab.session)) await edit;
  return performIn(page, tab, plan(tab.session.machine));
}

/** Applies an edit to a machine; false if it was refused. The session reports refusals by the server. */
export async function performIn(page: Page, tab: OpenTab, planned: Planned): Promise<boolean> {
  const made = applyPlan(page, tab, planned);
  if (typeof made === "string") page.tell({ level: "warning", text: made });
  return (await made) === null;
}
