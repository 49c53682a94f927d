/** Plans as text, for tests. */

import type { Edit } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { isRefused, type Plan, type Planned } from "../plan.ts";

export function drawn(text: string): Machine {
  return machineOf(sketch(text));
}

/** The plan; throws if it was refused. */
export function made(planned: Planned): Plan {
  if (isRefused(planned)) throw new Error(planned.refused);
  return planned;
}

/** Why it was refused; throws if it was not. */
export function reason(planned: unknown): string {
  if (!isRefused(planned)) throw new Error(`not refused: ${JSON.stringify(planned)}`);
  return planned.refused;
}

/** The edits one by one. */
export function editsOf(planned: Planned): readonly Edit[] {
  const { edit } = made(planned);
  return edit.edit === "batch" ? edit.edits : [edit];
}

/** Each edit as a line: its name, the state, and what else it says. */
export function lines(planned: Planned): readonly string[] {
  return editsOf(planned).map(({ edit, ...fields }) => {
    const { path = "", ...rest } = fields as { path?: string };
    const words = Object.entries(rest).map(([key, value]) => `${key}=${short(value)}`);
    return [edit, path, ...words].join(" ");
  });
}

function short(value: unknown): string {
  return typeof value === "string" ? value : JSON.stringify(value);
}
