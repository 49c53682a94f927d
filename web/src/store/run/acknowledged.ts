/** Acknowledged failures of runs, stored in this browser by run. */

import { computed, type ReadonlySignal, signal } from "@preact/signals-core";
import { perOwner } from "../../model/per_owner.ts";
import { type DroppedFailures, Failures, type RunFailure } from "../history/failures.ts";
import type { Journal } from "../history/journal.ts";
import { openQuestions } from "../history/questions.ts";
import type { Watch } from "../history/run.ts";
import { BROWSER_STORE, kept, type LocalStore } from "../local_store.ts";
import { openDecisions } from "./decisions.ts";

const KEY = "rafcon.acknowledged";
/** Capacity in runs, and in sequence numbers per run. The most recent acknowledgements are kept. */
const RUNS_MAX = 50;
const KEPT_MAX = 2_000;

type FailuresWatch = Pick<Watch, "id" | "journal" | "journalVersion">;

interface RunFailures {
  readonly failures: ReadonlySignal<readonly RunFailure[]>;
  readonly acknowledged: ReadonlySignal<ReadonlySet<number>>;
  readonly open: ReadonlySignal<readonly RunFailure[]>;
  readonly dropped: ReadonlySignal<DroppedFailures>;
}

/** Failures of a run, acknowledged or not, the oldest first. */
export function failures(watch: FailuresWatch): ReadonlySignal<readonly RunFailure[]> {
  return about(watch).failures;
}

/** Failures that nobody has acknowledged in this browser, the oldest first. */
export function openFailures(watch: FailuresWatch): ReadonlySignal<readonly RunFailure[]> {
  return about(watch).open;
}

/** Numbers of failures that were dropped from the list. */
export function droppedFailures(watch: FailuresWatch): ReadonlySignal<DroppedFailures> {
  return about(watch).dropped;
}

/** Number of items of a run that need a person: questions, decisions and failures. */
export function countUnacknowledged(watch: Watch | null): number {
  if (!watch) return 0;
  return openQuestions(watch).length + openDecisions(watch) + openFailures(watch).value.length;
}

/** Sequence numbers of acknowledged failures. */
export function acknowledged(watch: FailuresWatch): ReadonlySignal<ReadonlySet<number>> {
  return about(watch).acknowledged;
}

/** Acknowledges failures by their sequence numbers. */
export function acknowledge(
  watch: FailuresWatch,
  sequences: Iterable<number>,
  localStore: LocalStore = BROWSER_STORE,
): void {
  const { acknowledged } = about(watch, localStore);
  const all = [...new Set([...acknowledged.peek(), ...sequences])].slice(-KEPT_MAX);
  const known = knownIn(localStore);
  known.value = { ...known.peek(), [watch.id]: all };
  const { [watch.id]: _, ...others } = readKept(localStore);
  const runs = [...Object.entries(others), [watch.id, all] as const].slice(-RUNS_MAX);
  localStore.put(KEY, Object.fromEntries(runs));
}

const failuresIn = perOwner((_journal: Journal) => new Failures());

const about = perOwner((watch: FailuresWatch, localStore?: LocalStore): RunFailures => {
  const known = knownIn(localStore ?? BROWSER_STORE);
  const own = computed(() => known.value[watch.id]);
  const acknowledged = computed<ReadonlySet<number>>(() => new Set(own.value));
  const failures = computed(() => {
    watch.journalVersion.value;
    return failuresIn(watch.journal).found(watch.journal, acknowledged.peek());
  });
  const dropped = computed(() => {
    failures.value;
    return failuresIn(watch.journal).dropped;
  });
  const open = computed(() => {
    const done = acknowledged.value;
    return failures.value.filter(({ sequence }) => !done.has(sequence));
  });
  return { failures, acknowledged, open, dropped };
});

type ByRun = Readonly<Record<string, readonly number[]>>;

/** Acknowledgements of all runs, from this tab and the other tabs of the browser. */
const knownIn = perOwner((localStore: LocalStore) => {
  const known = signal(readKept(localStore));
  localStore.whenOther(KEY, () => {
    known.value = withMore(known.peek(), readKept(localStore));
  });
  return known;
});

/** Merges both. Lists without new numbers keep their object. */
function withMore(before: ByRun, more: ByRun): ByRun {
  const entries = Object.entries(more).map(([run, news]) => {
    const own = before[run] ?? [];
    const fresh = news.filter((sequence) => !own.includes(sequence));
    return [run, fresh.length === 0 ? own : [...own, ...fresh]] as const;
  });
  return { ...before, ...Object.fromEntries(entries) };
}

function readKept(localStore: LocalStore): ByRun {
  const entries = Object.entries(kept<Record<string, unknown>>(localStore, KEY) ?? {});
  return Object.fromEntries(
    entries.flatMap(([run, all]) =>
      Array.isArray(all) ? [[run, all.filter((number) => typeof number === "number")]] : [],
    ),
  );
}
