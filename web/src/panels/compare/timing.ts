/** Durations of states in two runs, as sortable rows. */

import type { Timing } from "../../model/generated/protocol.ts";

export interface TimingRow {
  readonly path: string;
  readonly names: string;
  readonly one: TimingSide;
  readonly other: TimingSide;
  /** Difference of the mean durations, in ms: positive if the state took longer in the first run. Null if it did not end in both. */
  readonly more_ms: number | null;
}

interface TimingSide {
  readonly count: number;
  /** Mean duration; null if the state never ended. */
  readonly mean_ms: number | null;
}

export type TimingOrder = "names" | "one" | "other" | "more" | "counts";

export function timingRows(timing: readonly Timing[]): readonly TimingRow[] {
  return timing.map(({ path, names, one, other }) => {
    const [here, there] = [side(one), side(other)];
    const isBoth = here.mean_ms !== null && there.mean_ms !== null;
    const more_ms = isBoth ? (here.mean_ms ?? 0) - (there.mean_ms ?? 0) : null;
    return { path, names, one: here, other: there, more_ms };
  });
}

function side({ count, total_ns }: Timing["one"]): TimingSide {
  return { count, mean_ms: count === 0 ? null : total_ns / count / 1e6 };
}

/** Sorts the rows. `down` puts the largest number, or the last name, first. */
export function sorted(
  rows: readonly TimingRow[],
  order: TimingOrder,
  down: boolean,
): readonly TimingRow[] {
  const weight = (row: TimingRow): number => {
    switch (order) {
      case "one":
        return row.one.mean_ms ?? -1;
      case "other":
        return row.other.mean_ms ?? -1;
      case "counts":
        return Math.abs(row.one.count - row.other.count);
      default:
        return Math.abs(row.more_ms ?? -1);
    }
  };
  const direction = down ? 1 : -1;
  return [...rows].sort((a, b) =>
    order === "names"
      ? -direction * a.names.localeCompare(b.names)
      : direction * (weight(b) - weight(a)) || a.names.localeCompare(b.names),
  );
}
