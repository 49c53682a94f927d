/** How hot states are in a run: by how often they were entered, or how long they ran altogether. Of what is counted: all
 * that was told of the run, or what had happened by a moment. */

import type { CountUntil } from "../history/counts_until.ts";
import type { HeatMode } from "../page/view.ts";

interface HeatOfRun {
  /** From 0, hardly, to the number of levels, by path. Only states that ran are in it. */
  readonly levels: ReadonlyMap<string, number>;
  /** What the hottest innermost state has: entries, or ms. */
  readonly most: number;
}

/** Containers take as long as all inside them: the innermost states say how hot hot is. */
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

/** Even steps for the eye: ten times as much is as far from ten as ten from one. */
function level(amount: number, most: number, levels: number): number {
  if (most <= 0) return 0;
  return Math.min(levels, Math.round((levels * Math.log1p(amount)) / Math.log1p(most)));
}
