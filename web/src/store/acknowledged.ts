/** Which failures of a run somebody has acknowledged, in this browser: kept in its storage by run. */

import { computed, type ReadonlySignal, type Signal, signal } from "@preact/signals-core";
import { type Failure, Failures } from "./failures.ts";
import { openQuestions } from "./questions.ts";
import type { Watch } from "./run.ts";
import { kept, memoryShed, type Shed, shedOf } from "./shed.ts";

const KEY = "rafcon.acknowledged";
/** So many runs are remembered, and so many sequence numbers of each: those that were acknowledged last. */
const RUNS_MAX = 50;
const KEPT_MAX = 2_000;

type Known = Pick<Watch, "id" | "journal" | "grown">;

interface About {
  readonly failures: ReadonlySignal<readonly Failure[]>;
  readonly acknowledged: Signal<ReadonlySet<number>>;
  readonly open: ReadonlySignal<readonly Failure[]>;
}

const ALL = new WeakMap<Known, About>();
const SHED: Shed = typeof window === "undefined" ? memoryShed() : shedOf(() => window.localStorage);

/** What wants acknowledgement, and what was acknowledged already; the oldest first. */
export function failures(watch: Known): ReadonlySignal<readonly Failure[]> {
  return about(watch).failures;
}

/** The failures that nobody has acknowledged here; the oldest first. */
export function openFailures(watch: Known): ReadonlySignal<readonly Failure[]> {
  return about(watch).open;
}

/** How many things of a run want a human: questions and failures. */
export function countWanting(watch: Watch | null): number {
  return watch ? openQuestions(watch).length + openFailures(watch).value.length : 0;
}

/** The sequence numbers of what was acknowledged. */
export function acknowledged(watch: Known): Signal<ReadonlySet<number>> {
  return about(watch).acknowledged;
}

/** Acknowledges failures by their sequence numbers. */
export function acknowledge(watch: Known, sequences: Iterable<number>, shed: Shed = SHED): void {
  const { acknowledged } = about(watch);
  const all = [...new Set([...acknowledged.peek(), ...sequences])].slice(-KEPT_MAX);
  acknowledged.value = new Set(all);
  const { [watch.id]: _, ...others } = kept<Record<string, readonly number[]>>(shed, KEY) ?? {};
  const runs = [...Object.entries(others), [watch.id, all] as const].slice(-RUNS_MAX);
  shed.put(KEY, Object.fromEntries(runs));
}

function about(watch: Known, shed: Shed = SHED): About {
  const there = ALL.get(watch);
  if (there) return there;
  const walker = new Failures();
  const failures = computed(() => {
    watch.grown.value;
    return walker.found(watch.journal);
  });
  const acknowledged = signal<ReadonlySet<number>>(new Set(keptOf(watch.id, shed)));
  takeFromOthers(acknowledged, watch.id, shed);
  const open = computed(() => {
    const done = acknowledged.value;
    return failures.value.filter(({ sequence }) => !done.has(sequence));
  });
  const made = { failures, acknowledged, open };
  ALL.set(watch, made);
  return made;
}

/** What is acknowledged in another tab of the browser is acknowledged here. */
function takeFromOthers(known: Signal<ReadonlySet<number>>, run: string, shed: Shed): void {
  shed.whenOther(KEY, () => {
    known.value = new Set([...known.peek(), ...keptOf(run, shed)]);
  });
}

function keptOf(run: string, shed: Shed): readonly number[] {
  const all = kept<Record<string, unknown>>(shed, KEY)?.[run];
  return Array.isArray(all) ? all.filter((number) => typeof number === "number") : [];
}
