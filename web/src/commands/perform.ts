/** The way of every edit from a command to the machine: refused with a reason, or made, and what it made is selected. */

import type { Machine } from "../model/machine.ts";
import { isRefused, type Planned } from "../plan/plan.ts";
import { type MachineSession, wasRefused } from "../store/document/machine_session.ts";
import type { OpenTab, Page } from "../store/page/page.ts";
import { whyFixed } from "../store/page/rights.ts";
import { isThere } from "../store/page/selection.ts";
import { select } from "../store/page/view.ts";
import type { CommandContext } from "./command.ts";

/** Edits that are not shown before they are answered, by machine: until then the selection names what they are about to change. */
const UNSHOWN = new WeakMap<MachineSession, Promise<unknown>>();

/** Applies the edit to the current machine; false if it was refused, which is reported. What was done in a hurry after an
 * edit that is not shown yet waits for it, and is planned by what is selected then. */
export async function perform(
  context: CommandContext,
  plan: (machine: Machine) => Planned,
): Promise<boolean> {
  const { page, tab } = context;
  if (!tab) return false;
  const { session } = tab;
  while (UNSHOWN.has(session)) await UNSHOWN.get(session);
  return performIn(page, tab, plan(session.machine));
}

export async function performIn(page: Page, tab: OpenTab, planned: Planned): Promise<boolean> {
  const why = whyFixed(page, tab) ?? (isRefused(planned) ? planned.refused : null);
  if (why !== null || isRefused(planned)) {
    page.tell({ level: "warning", text: tab.session.named(why ?? "") });
    return false;
  }
  const { session, view } = tab;
  const wanted = planned.select;
  const answered = session.edit(planned.name, planned.edit);
  const early = wanted?.every((each) => isThere(session.machine, each));
  if (wanted && early) select(view, wanted);
  const taken = answered.then((answer) => {
    if (wasRefused(answer)) return false;
    if (wanted && !early) {
      select(
        view,
        wanted.filter((each) => isThere(session.machine, each)),
      );
    }
    return true;
  });
  if (wanted && !early) {
    const unshown = taken.finally(() => {
      if (UNSHOWN.get(session) === unshown) UNSHOWN.delete(session);
    });
    UNSHOWN.set(session, unshown);
  }
  return taken;
}
