/** Usual durations of a run and of its states, from earlier runs of the machine and from this one. */

import { type ReadonlySignal, type Signal, signal } from "@preact/signals-core";
import type { RunSummary, Statistics } from "../../model/generated/protocol.ts";
import { isSame } from "../../model/json.ts";
import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import { RefusalError } from "../page/server.ts";
import type { Active } from "./active.ts";
import { summaryOf } from "./running.ts";

/** Usual duration of a state. `max_ms` is the longest one. */
export interface Baseline {
  /** Median duration if there are enough of them; otherwise the mean. */
  readonly typical_ms: number;
  readonly isMedian: boolean;
  readonly max_ms: number;
  /** Number of durations. */
  readonly count: number;
}

/** Number of durations for a median. With this many in the current run, earlier runs no longer count. */
const ENOUGH = 5;
/** Margins over the longest duration, as a factor and in ms. Both must be exceeded. */
const LONGER = 1.1;
const LONGER_MS = 1_000;
/** Number of earlier runs to consider, the newest ones. */
const RUNS_MAX = 20;

/** Capacity of the cache of earlier runs. */
const PAST_MAX = 50;
const PAST = new Map<string, Signal<ReadonlyMap<string, Baseline>>>();
const NONE: ReadonlyMap<string, Baseline> = new Map();

/** Earlier runs of the machine that finished neither aborted nor preempted, the newest first. */
export function earlierRuns(page: Page, watch: Watch): readonly RunSummary[] {
  const own = summaryOf(page, watch);
  const file = own?.machine;
  if (!own || !file) return [];
  const isLike = (run: RunSummary) =>
    run.id !== own.id &&
    run.started_ms < own.started_ms &&
    run.phase === "finished" &&
    run.outcome.id >= 0 &&
    run.machine !== null &&
    isSame(run.machine, file);
  return page.runs.all.value.filter(isLike).slice(0, RUNS_MAX);
}

/** Expected duration of a run, in ms: the median if there are enough earlier runs, otherwise the mean; null without any. */
export function expectedLength(
  earlier: readonly Pick<RunSummary, "length_ms">[],
): { readonly length_ms: number; readonly isMedian: boolean } | null {
  const lengths = earlier.map(({ length_ms }) => length_ms);
  if (lengths.length === 0) return null;
  const isMedian = lengths.length >= ENOUGH;
  const mean = lengths.reduce((sum, length) => sum + length, 0) / lengths.length;
  return { length_ms: isMedian ? median(lengths) : mean, isMedian };
}

function median(lengths: readonly number[]): number {
  const sorted = [...lengths].sort((one, other) => one - other);
  const half = sorted.length >> 1;
  const [low, high] = [sorted[half - 1 + (sorted.length % 2)] ?? 0, sorted[half] ?? 0];
  return (low + high) / 2;
}

/** Durations of states in an earlier run. Requested once; empty until they arrive. */
export function pastBaselines(
  page: Page,
  run: string | null,
): ReadonlySignal<ReadonlyMap<string, Baseline>> {
  if (run === null) return NOTHING;
  const before = PAST.get(run);
  const known = before ?? signal(NONE);
  // The last requested run moves to the end, and the first one is evicted.
  PAST.delete(run);
  PAST.set(run, known);
  const [oldest] = PAST.keys();
  if (PAST.size > PAST_MAX && oldest !== undefined) PAST.delete(oldest);
  if (!before) void ask(page, run, known);
  return known;
}

const NOTHING = signal(NONE);

async function ask(page: Page, run: string, into: Signal<ReadonlyMap<string, Baseline>>) {
  try {
    const { states } = await page.runs.get<Statistics>(run, "statistics");
    into.value = new Map(
      states.map(({ path, total_ns, median_ns, max_ns, count }) => {
        const isMedian = count >= ENOUGH;
        const typical_ms = (isMedian ? median_ns : total_ns / Math.max(1, count)) / 1e6;
        return [path, { typical_ms, isMedian, max_ms: max_ns / 1e6, count }];
      }),
    );
  } catch (error) {
    if (!(error instanceof RefusalError)) throw error;
    PAST.delete(run);
  }
}

/** Usual duration of a state; null if unknown. */
export function baselineOf(
  { journal }: Watch,
  past: ReadonlyMap<string, Baseline>,
  path: string,
): Baseline | null {
  const own = journal.counts.get(path);
  const before = past.get(path) ?? null;
  if (!own || own.ends === 0 || (own.ends < ENOUGH && before)) return before;
  const isMedian = own.ends >= ENOUGH;
  const typical_ns = isMedian ? median(own.lengths_ns) : own.total_ns / own.ends;
  return { typical_ms: typical_ns / 1e6, isMedian, max_ms: own.max_ns / 1e6, count: own.ends };
}

/** True if a state takes longer than ever before, compared with enough durations. Waiting and held states never do, because their
 * time depends on others. */
export function isLongerThanEver(
  { phase }: Pick<Active, "phase">,
  baseline: Baseline,
  since_ms: number,
) {
  const { isMedian, max_ms } = baseline;
  const isAtWork = phase === "running" || phase === "preempted";
  return isMedian && isAtWork && since_ms > max_ms * LONGER && since_ms > max_ms + LONGER_MS;
}

/** Describes a baseline: `usually 1.3 s, at most 4 s (12 times)`. */
export function usualInWords(baseline: Baseline, duration: (ms: number) => string): string {
  const { typical_ms, isMedian, max_ms, count } = baseline;
  if (count === 1) return `${duration(typical_ms)} the one time before`;
  const typical = `${isMedian ? "usually" : "on average"} ${duration(typical_ms)}`;
  return `${typical}, at most ${duration(max_ms)} (${count} times)`;
}
