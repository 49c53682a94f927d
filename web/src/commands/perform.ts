/** The way of every edit from a command to the machine: refused with a reason, or made, and what it made is selected. */

import type { Machine } from "../model/machine.ts";
import { isRefused, type Planned } from "../plan/plan.ts";
import type { OpenTab, Page } from "../store/page.ts";
import { whyFixed } from "../store/rights.ts";
import { type Room, wasRefused } from "../store/room.ts";
import { isThere } from "../store/selection.ts";
import { select } from "../store/view.ts";
import type { Context } from "./command.ts";

/** Edits that are not shown before they are answered, by machine: until then the selection names what they are about to change. */
const UNSHOWN = new WeakMap<Room, Promise<unknown>>();

/** Makes the edit in the machine in front; false if it was refused, which the user is told. What was done in a hurry after an
 * edit that is not shown yet waits for it, and is planned by what is selected then. */
export async function perform(
  context: Context,
  plan: (machine: Machine) => Planned,
): Promise<boolean> {
  const { page, tab } = context;
  if (!tab) return false;
  const { room } = tab;
  while (UNSHOWN.has(room)) await UNSHOWN.get(room);
  return performIn(page, tab, plan(room.machine));
}

export async function performIn(page: Page, tab: OpenTab, planned: Planned): Promise<boolean> {
  const why = whyFixed(page, tab) ?? (isRefused(planned) ? planned.refused : null);
  if (why !== null || isRefused(planned)) {
    page.tell({ level: "warning", text: tab.room.named(why ?? "") });
    return false;
  }
  const { room, view } = tab;
  const wanted = planned.select;
  const answered = room.edit(planned.name, planned.edit);
  const early = wanted?.every((each) => isThere(room.machine, each));
  if (wanted && early) select(view, wanted);
  const taken = answered.then((answer) => {
    if (wasRefused(answer)) return false;
    if (wanted && !early) {
      select(
        view,
        wanted.filter((each) => isThere(room.machine, each)),
      );
    }
    return true;
  });
  if (wanted && !early) {
    const unshown = taken.finally(() => {
      if (UNSHOWN.get(room) === unshown) UNSHOWN.delete(room);
    });
    UNSHOWN.set(room, unshown);
  }
  return taken;
}
