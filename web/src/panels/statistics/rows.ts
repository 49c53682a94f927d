/** Rows of the table of statistics: filter and order. All functions are pure. */

import type { StateStatistics } from "../../model/generated/protocol.ts";

type SortKey = "names" | "count" | "total" | "min" | "median" | "p95" | "max";

export interface Sort {
  readonly key: SortKey;
  readonly down: boolean;
}

const NUMBERS: Readonly<Record<Exclude<SortKey, "names">, (row: StateStatistics) => number>> = {
  count: ({ count }) => count,
  total: ({ total_ns }) => total_ns,
  min: ({ min_ns }) => min_ns,
  median: ({ median_ns }) => median_ns,
  p95: ({ p95_ns }) => p95_ns,
  max: ({ max_ns }) => max_ns,
};

function isSortKey(key: string): key is SortKey {
  return key === "names" || key in NUMBERS;
}

/** States with all words of the query in their names or outcomes, sorted; equal ones by path. */
export function rowsOf(
  states: readonly StateStatistics[],
  query: string,
  { key, down }: Sort,
): readonly StateStatistics[] {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  const found = states.filter((row) => {
    const text = `${row.names} ${row.outcomes.map(({ outcome }) => outcome.name).join(" ")}`;
    const lower = text.toLowerCase();
    return words.every((word) => lower.includes(word));
  });
  const side = down ? -1 : 1;
  if (key === "names")
    return found.sort((one, other) => side * one.names.localeCompare(other.names));
  const number = NUMBERS[key];
  return found.sort((one, other) => side * (number(one) - number(other)));
}

/** Order after a click on a column title. Names start rising, numbers falling. */
export function sortedBy(sort: Sort, key: string): Sort {
  if (!isSortKey(key)) return sort;
  return { key, down: sort.key === key ? !sort.down : key !== "names" };
}

/** Logarithmic scale of durations from the shortest (0) to the longest (1) of all states. */
export function scaleOf(states: readonly StateStatistics[]): (ns: number) => number {
  const least = Math.log(Math.max(1, Math.min(...states.map(({ min_ns }) => min_ns))));
  const most = Math.log(Math.max(1, Math.max(...states.map(({ max_ns }) => max_ns))));
  if (!(most > least)) return () => 0.5;
  return (ns) => Math.max(0, Math.min(1, (Math.log(Math.max(1, ns)) - least) / (most - least)));
}
