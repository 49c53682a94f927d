/** Comparison of the shown run with another one. It is requested when the other run is chosen, and again when the shown run ends. */

import { signal } from "@preact/signals-core";
import type { Comparison } from "../../model/generated/protocol.ts";
import { perOwner } from "../../model/per_owner.ts";
import { comparedRun } from "../../store/history/compared_run.ts";
import type { Watch } from "../../store/history/run.ts";
import type { Page } from "../../store/page/page.ts";
import { RefusalError } from "../../store/page/server.ts";

export interface Compared {
  readonly other: string;
  /** Null until it is loaded. */
  readonly comparison: Comparison | null;
  /** Reason why the comparison failed. */
  readonly refusal: string | null;
}

/** Comparison that was chosen for a run; null if there is none. */
export const comparedOf = perOwner((_watch: Watch) => signal<Compared | null>(null));

/** Requests the comparison from the server. */
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

/** First time at which the shown run differs from the other one; null without a comparison or a difference. */
export function partedAt(watch: Watch): number | null {
  const first = comparedOf(watch).value?.comparison?.parted[0];
  return first?.one?.t_ns ?? null;
}
