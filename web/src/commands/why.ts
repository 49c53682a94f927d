/** Why a command that is plainly out of the question is so: for those who ask for it by a key, without a menu before their eyes. */

import { whyFixed } from "../store/page/rights.ts";
import type { CommandContext, UserCommand } from "./command.ts";
import { whyNot } from "./subject.ts";

/** The reason, or what to do first; null while no machine is open, or if there is nothing to say. */
export function whyDisabled(command: UserCommand, context: CommandContext): string | null {
  const { page, tab } = context;
  if (!tab) return null;
  const fixed = isEdit(command) ? whyFixed(page, tab) : null;
  return fixed ?? whyNot(context) ?? command.needs ?? null;
}

function isEdit({ id }: UserCommand): boolean {
  return /^(edit\.(cut|paste|duplicate|delete|rename|undo|redo)|insert\.|arrange\.|file\.save)/.test(
    id,
  );
}
