/** The only way of a planned edit to a machine: checks the rights, sends the edit, and selects its result once it is visible. */

import type { ElementRef } from "../../model/element.ts";
import type { Edit } from "../../model/generated/protocol.ts";
import { type MachineSession, wasRefused } from "../document/machine_session.ts";
import type { OpenTab } from "./page.ts";
import { whyFixed } from "./rights.ts";
import { isThere } from "./selection.ts";
import { select } from "./view.ts";

/** One named edit with the selection after it, or the reason of a refusal. */
export type AppliedPlan =
  | { readonly name: string; readonly edit: Edit; readonly select?: readonly ElementRef[] }
  | { readonly refused: string };

/** Result of an edit: an immediate refusal, or the response of the server. Null means success. */
export type Made = string | Promise<string | null>;

type EditedTab = Pick<OpenTab, "session" | "view">;

/** Edits whose result is not visible before their answer, by machine. Until then the selection names elements that they change. */
const UNSHOWN = new WeakMap<MachineSession, Promise<unknown>>();

/** Applies a plan, and selects its result unless the selection is kept. */
export function applyPlan(
  page: Parameters<typeof whyFixed>[0],
  { session, view }: EditedTab,
  planned: AppliedPlan,
  selection: "set" | "keep" = "set",
): Made {
  const fixed = whyFixed(page, { session });
  if (fixed !== null) return fixed;
  if ("refused" in planned) return session.named(planned.refused);
  const answered = session.edit(planned.name, planned.edit);
  const made = answered.then((answer) =>
    wasRefused(answer) ? session.named(answer.refused) : null,
  );
  const wanted = selection === "set" ? planned.select : undefined;
  if (!wanted) return made;
  if (wanted.every((each) => isThere(session.machine, each))) {
    select(view, wanted);
    return made;
  }
  const unshown = made.then((refusal) => {
    if (UNSHOWN.get(session) === unshown) UNSHOWN.delete(session);
    const there = wanted.filter((each) => isThere(session.machine, each));
    if (refusal === null) select(view, there);
    return refusal;
  });
  UNSHOWN.set(session, unshown);
  return unshown;
}

/** Settles when the result of the last edit is visible; undefined if it is. */
export function unshownEdit(session: MachineSession): Promise<unknown> | undefined {
  return UNSHOWN.get(session);
}
