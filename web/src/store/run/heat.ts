/** Heat of states in a run: by number of entries, or by total duration. The counts cover all received events, or those up to a moment. */

import type { CountUntil } from "../history/counts_until.ts";
import type { HeatMode } from "../page/view.ts";

interface HeatOfRun {
  /** Level by path, from 0 to the number of levels. Contains only states that ran. */
  readonly levels: ReadonlyMap<string, number>;
  /** Greatest amount of an innermost state: entries, or ms. */
  readonly most: number;
}

/** Computes the levels. Innermost states define the scale, because containers include the time of everything inside them. */
export function heatOf(
  counts: Iterable<CountUntil>,
  mode: Exclude<HeatMode, "off">,
  levels: number,
): HeatOfRun {
  const all = [...counts];
  const outer = new Set(all.map(({ path }) => path.slice(0, Math.max(0, path.lastIndexOf("/")))));
  const amount = mode === "count" ? byCount : byTime;
  const most = all.reduce((found, count) => {
    return outer.has(count.path) ? found : Math.max(found, amount(count));
  }, 0);
  const found = new Map(
    all
      .filter(({ entries }) => entries > 0)
      .map((count) => [count.path, level(amount(count), most, levels)]),
  );
  return { levels: found, most };
}

const byCount = ({ entries }: CountUntil) => entries;
const byTime = ({ total_ns }: CountUntil) => total_ns / 1e6;

/** Logarithmic scale: equal factors make equal steps. */
function level(amount: number, most: number, levels: number): number {
  if (most <= 0) return 0;
  return Math.min(levels, Math.round((levels * Math.log1p(amount)) / Math.log1p(most)));
}
