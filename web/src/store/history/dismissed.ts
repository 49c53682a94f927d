/** Commands without effect whose fate the user has seen, by run. They are not shown again. */

import { signal } from "@preact/signals-core";
import { perOwner } from "../../model/per_owner.ts";
import type { Watch } from "./run.ts";

/** Ids of commands. */
export const dismissed = perOwner((_watch: Watch) => signal<ReadonlySet<string>>(new Set()));

export function dismiss(watch: Watch, id: string): void {
  const seen = dismissed(watch);
  seen.value = new Set([...seen.peek(), id]);
}
