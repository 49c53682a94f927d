/** Where the run that is shown parts from the one that it is compared with: asked for when that is chosen, and once more when the run
 * is over. */

import { signal } from "@preact/signals-core";
import type { Comparison } from "../../model/generated/protocol.ts";
import { perOwner } from "../../model/per_owner.ts";
import { comparedRun } from "../../store/history/compared_run.ts";
import type { Watch } from "../../store/history/run.ts";
import type { Page } from "../../store/page/page.ts";
import { RefusalError } from "../../store/page/server.ts";

export interface Compared {
  readonly other: string;
  /** Null while it is asked for. */
  readonly comparison: Comparison | null;
  /** Why there is none. */
  readonly refusal: string | null;
}

/** What the comparison says that was chosen for a run; null if none is. */
export const comparedOf = perOwner((_watch: Watch) => signal<Compared | null>(null));

/** Asks the server anew. */
export async function compareNow(page: Page, watch: Watch): Promise<void> {
  const other = comparedRun(watch).peek();
  const compared = comparedOf(watch);
  if (other === null) {
    compared.value = null;
    return;
  }
  if (compared.peek()?.other !== other) compared.value = { other, comparison: null, refusal: null };
  const isCurrent = () => comparedRun(watch).peek() === other;
  try {
    const what = `compare/${encodeURIComponent(other)}`;
    const comparison = await page.runs.get<Comparison>(watch.id, what);
    if (isCurrent()) compared.value = { other, comparison, refusal: null };
  } catch (error) {
    if (!(error instanceof RefusalError)) throw error;
    if (isCurrent()) compared.value = { other, comparison: null, refusal: error.message };
  }
}

/** When the run that is shown first parts from the other one; null if nothing is compared, or they do not part. */
export function partedAt(watch: Watch): number | null {
  const first = comparedOf(watch).value?.comparison?.parted[0];
  return first?.one?.t_ns ?? null;
}
