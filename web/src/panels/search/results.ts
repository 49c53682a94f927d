/** Results of a search in one machine or in all open machines, the best first. */

import { type SearchHit, type SearchScope, search } from "../../model/search.ts";
import type { OpenTab } from "../../store/page/page.ts";

export interface SearchResult {
  readonly key: string;
  readonly tab: OpenTab;
  readonly hit: SearchHit;
}

export interface Results {
  readonly results: readonly SearchResult[];
  readonly total: number;
}

/** Maximum number of results. More words narrow them down. */
export const SHOWN_MAX = 300;

export function resultsIn(
  tabs: readonly OpenTab[],
  text: string,
  scope: SearchScope | null,
): Results {
  const found = tabs.map((tab) => ({
    tab,
    ...search(tab.session.machine, text, { scope, count: SHOWN_MAX }),
  }));
  const results = found.flatMap(({ tab, hits }) => hits.map((hit) => ({ tab, hit })));
  if (tabs.length > 1) results.sort((one, other) => other.hit.score - one.hit.score);
  return {
    total: found.reduce((sum, { total }) => sum + total, 0),
    results: results
      .slice(0, SHOWN_MAX)
      .map((result, index) => ({ ...result, key: `${index}:${result.hit.element.path}` })),
  };
}
