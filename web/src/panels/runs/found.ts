/** Search for runs. */

import type { RunSummary } from "../../model/generated/protocol.ts";
import { statusInWords, summaryStatusWords } from "../../model/run_words.ts";

/** Runs with every word of the search in their name, id, folder, author or status. */
export function foundRuns(all: readonly RunSummary[], search: string): readonly RunSummary[] {
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  if (words.length === 0) return all;
  return all.filter((run) => {
    const text = textOf(run);
    return words.every((word) => text.includes(word));
  });
}

function textOf(run: RunSummary): string {
  const status = statusInWords(summaryStatusWords(run));
  return `${run.name} ${run.id} ${run.machine?.path ?? ""} ${run.author ?? ""} ${status}`.toLowerCase();
}
