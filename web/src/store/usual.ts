/** How long things usually take: a run of this machine, and each of its states; by earlier runs and by what this one did so far. */

import { type ReadonlySignal, type Signal, signal } from "@preact/signals-core";
import type { RunSummary, Statistics } from "../model/generated/protocol.ts";
import { isSame } from "../model/json.ts";
import type { Page } from "./page.ts";
import type { Watch } from "./run.ts";
import { summaryOf } from "./running.ts";
import { RefusalError } from "./server.ts";

/** How long a state was active: half of the times no longer than `median_ms`, never longer than `max_ms`. */
export interface Usual {
  readonly median_ms: number;
  readonly max_ms: number;
  /** How often it was seen. */
  readonly count: number;
}

/** So often a state has to have run in this run before earlier runs do not count any more. */
const ENOUGH = 5;
/** Of so many earlier runs the length is looked at, the newest. */
const RUNS_MAX = 20;

const PAST = new Map<string, Signal<ReadonlyMap<string, Usual>>>();
const NONE: ReadonlyMap<string, Usual> = new Map();

/** Runs of the same machine that came to a good end before, the newest first. */
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

/** How long such a run usually takes: the median of earlier ones, in ms; null if there are none. */
export function expectedLength(earlier: readonly RunSummary[]): number | null {
  const lengths = earlier.map(({ length_ms }) => length_ms).sort((one, other) => one - other);
  const half = lengths.length >> 1;
  const [low, high] = [lengths[half - 1 + (lengths.length % 2)], lengths[half]];
  return low === undefined || high === undefined ? null : (low + high) / 2;
}

/** How long states of this machine were active in an earlier run; asked for once, and empty until that is here. */
export function pastUsual(
  page: Page,
  run: string | null,
): ReadonlySignal<ReadonlyMap<string, Usual>> {
  if (run === null) return NOTHING;
  let known = PAST.get(run);
  if (!known) {
    known = signal(NONE);
    PAST.set(run, known);
    void ask(page, run, known);
  }
  return known;
}

const NOTHING = signal(NONE);

async function ask(page: Page, run: string, into: Signal<ReadonlyMap<string, Usual>>) {
  try {
    const { states } = await page.runs.get<Statistics>(run, "statistics");
    into.value = new Map(
      states.map(({ path, median_ns, max_ns, count }) => [
        path,
        { median_ms: median_ns / 1e6, max_ms: max_ns / 1e6, count },
      ]),
    );
  } catch (error) {
    if (!(error instanceof RefusalError)) throw error;
    PAST.delete(run);
  }
}

/** How long a state usually takes; null if nobody knows. */
export function usualOf(
  { journal }: Watch,
  past: ReadonlyMap<string, Usual>,
  path: string,
): Usual | null {
  const own = journal.counts.get(path);
  const before = past.get(path) ?? null;
  if (!own || own.ends === 0 || (own.ends < ENOUGH && before)) return before;
  return { median_ms: own.total_ns / own.ends / 1e6, max_ms: own.max_ns / 1e6, count: own.ends };
}
