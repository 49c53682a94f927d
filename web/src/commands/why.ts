/** Obvious reasons of unavailable commands, for users who press a key and see no menu. */

import { whyFixed } from "../store/page/rights.ts";
import type { CommandContext, UserCommand } from "./command.ts";
import { whyNot } from "./subject.ts";

/** The reason or an instruction; null while no machine is open, or without a reason. */
export function whyDisabled(command: UserCommand, context: CommandContext): string | null {
  const { page, tab } = context;
  if (!tab) return null;
  const fixed = command.edits ? whyFixed(page, tab) : null;
  return fixed ?? whyNot(context) ?? command.needs ?? null;
}
