/** A period of a run as the server summarizes it: lanes and rows like those of loaded calls, most of which are never loaded. */

import type { CallEnd, Overview, OverviewBar } from "../../model/generated/protocol.ts";
import { parentOf } from "../../model/path.ts";
import { lowerBound } from "./column.ts";
import { inOrder } from "./lanes.ts";

/** A bar with the path of its state. */
export interface SeenBar extends Omit<OverviewBar, "place" | "end"> {
  readonly path: string;
  readonly look: CallEnd;
}

/** Consecutive bars at one depth of a branch. */
export class SeenRow {
  readonly bars: readonly SeenBar[];

  constructor(bars: readonly SeenBar[]) {
    this.bars = bars;
  }

  /** Bars that overlap a period. */
  between(from_ns: number, to_ns: number): readonly SeenBar[] {
    const first = lowerBound(
      this.bars.length,
      (place) => (this.bars[place]?.to_ns ?? Number.POSITIVE_INFINITY) < from_ns,
    );
    const until = lowerBound(
      this.bars.length,
      (place) => (this.bars[place]?.from_ns ?? 0) <= to_ns,
    );
    return this.bars.slice(first, until);
  }
}

export interface SeenLane {
  readonly path: string;
  readonly depth: number;
  readonly parent: string | null;
  readonly rows: readonly SeenRow[];
  /** The innermost row. */
  readonly leaves: SeenRow;
}

interface RowPlace {
  readonly lane: string;
  readonly row: number;
}

/** All lanes, each after the lane around it. */
export function lanesSeen({ concurrent, paths, rows }: Overview): readonly SeenLane[] {
  const split = new Set(concurrent);
  const places = new Map<string, RowPlace>();
  const placeOf = (path: string): RowPlace => {
    const known = places.get(path);
    if (known) return known;
    const around = parentOf(path);
    const outer = around === null || split.has(around) ? null : placeOf(around);
    const place = outer ? { lane: outer.lane, row: outer.row + 1 } : { lane: path, row: 0 };
    places.set(path, place);
    return place;
  };
  const lanes = new Map<string, SeenBar[][]>();
  const barsOf = ({ lane, row }: RowPlace): SeenBar[] => {
    const all = lanes.get(lane) ?? [];
    lanes.set(lane, all);
    while (all.length <= row) all.push([]);
    return all[row] ?? [];
  };
  const outerLane = (lane: string): string | null => {
    const around = parentOf(lane);
    return around === null ? null : placeOf(around).lane;
  };
  for (const { place, bars } of rows) {
    const into = barsOf(placeOf(paths[place] ?? ""));
    for (const { place: of, end: look, ...bar } of bars) {
      into.push({ ...bar, look, path: paths[of] ?? "" });
    }
  }
  for (const lane of [...lanes.keys()]) {
    for (let at = outerLane(lane); at !== null; at = outerLane(at)) barsOf({ lane: at, row: 0 });
  }
  const depthOf = (lane: string): number => {
    const outer = outerLane(lane);
    return outer === null ? 0 : depthOf(outer) + 1;
  };
  const drafts = [...lanes].map(([path, all]): SeenLane => {
    const seen = all.map((bars) => new SeenRow(bars.sort(byTime)));
    const leaves = seen.findLast(({ bars }) => bars.length > 0) ?? new SeenRow([]);
    return { path, depth: depthOf(path), parent: outerLane(path), rows: seen, leaves };
  });
  return inOrder(drafts.sort((one, other) => begin(one) - begin(other)));
}

function byTime(one: SeenBar, other: SeenBar): number {
  return one.from_ns - other.from_ns || one.sequence - other.sequence;
}

function begin({ rows }: SeenLane): number {
  return rows[0]?.bars[0]?.from_ns ?? 0;
}
