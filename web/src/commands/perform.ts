/** The way of every edit from a command to the machine: refused with a reason, or made, and what it made is selected. */

import type { Machine } from "../model/machine.ts";
import { isRefused, type Planned } from "../plan/plan.ts";
import type { OpenTab, Page } from "../store/page.ts";
import { whyFixed } from "../store/rights.ts";
import { wasRefused } from "../store/room.ts";
import { isThere } from "../store/selection.ts";
import { select } from "../store/view.ts";
import type { Context } from "./command.ts";

/** Makes the edit in the machine in front; false if it was refused, which the user is told. */
export function perform(context: Context, plan: (machine: Machine) => Planned): Promise<boolean> {
  const { page, tab } = context;
  return tab ? performIn(page, tab, plan(tab.room.machine)) : Promise.resolve(false);
}

export async function performIn(page: Page, tab: OpenTab, planned: Planned): Promise<boolean> {
  const why = whyFixed(page, tab) ?? (isRefused(planned) ? planned.refused : null);
  if (why !== null || isRefused(planned)) {
    page.tell({ level: "warning", text: why ?? "" });
    return false;
  }
  const { room, view } = tab;
  const wanted = planned.select;
  const answered = room.edit(planned.name, planned.edit);
  const early = wanted?.every((each) => isThere(room.machine, each));
  if (wanted && early) select(view, wanted);
  const answer = await answered;
  if (wasRefused(answer)) return false;
  if (wanted && !early) {
    select(
      view,
      wanted.filter((each) => isThere(room.machine, each)),
    );
  }
  return true;
}
