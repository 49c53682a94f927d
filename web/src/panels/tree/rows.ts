/** States that the tree shows: all, or those that match a filter with the states around them. */

import type { Machine } from "../../model/machine.ts";
import { match, queryOf, type TextSpan } from "../../model/match.ts";
import { idOf, parentOf } from "../../model/path.ts";

interface Filtered {
  /** Visible states; null for all. */
  readonly shown: ReadonlySet<string> | null;
  /** Matching parts of the names. */
  readonly spans: ReadonlyMap<string, readonly TextSpan[]>;
}

const ALL: Filtered = { shown: null, spans: new Map() };

/** Filters by names and ids, including loaded content of libraries. */
export function filtered(machine: Machine, text: string): Filtered {
  const query = queryOf(text);
  if (query.words.length === 0) return ALL;
  const shown = new Set<string>();
  const spans = new Map<string, readonly TextSpan[]>();
  const pending = [machine.root];
  for (let path = pending.pop(); path !== undefined; path = pending.pop()) {
    const state = machine.state(path);
    if (!state) continue;
    pending.push(...machine.children(path));
    const name = match(query, state.name);
    if (!name && !match(query, idOf(path))) continue;
    spans.set(path, name?.spans ?? []);
    for (let at: string | null = path; at !== null && !shown.has(at); at = parentOf(at)) {
      shown.add(at);
    }
  }
  return { shown, spans };
}
