/** Values that the user watches, by machine. Stored in this browser. */

import { type Signal, signal } from "@preact/signals-core";
import { BROWSER_STORE, kept } from "../local_store.ts";
import type { OpenTab } from "../page/page.ts";

/** A value of a run: at a port or in a scoped variable of a state, or a global variable. */
export interface Target {
  readonly kind: "input" | "output" | "scoped_variable" | "global";
  /** Path of the state; empty for global variables. */
  readonly path: string;
  readonly name: string;
}

export interface WatchedExpression {
  readonly id: number;
  readonly target: Target;
  /** Watched part of the value: an expression over `value`. */
  readonly expression: string;
}

/** The whole value. */
export const WHOLE = "value";

const KEY = "rafcon.watched";
const MACHINES_MAX = 50;

type KeptWatches = Readonly<Record<string, readonly WatchedExpression[]>>;

const known = new Map<string, Signal<readonly WatchedExpression[]>>();

/** Watches of a tab's machine. Runs of one machine share them. */
export function watchedOf(tab: OpenTab): Signal<readonly WatchedExpression[]> {
  const key = machineKey(tab);
  let found = known.get(key);
  if (!found) {
    if (known.size === 0) takeFromOthers();
    found = signal(keptWatches()[key] ?? []);
    known.set(key, found);
  }
  return found;
}

/** Adopts the changes of other tabs of the browser. */
function takeFromOthers(): void {
  globalThis.addEventListener?.("storage", ({ key }) => {
    if (key !== KEY && key !== null) return;
    const now = keptWatches();
    for (const [machine, watched] of known) watched.value = now[machine] ?? [];
  });
}

/** Adds a watch, unless it exists already. */
export function addWatched(tab: OpenTab, target: Target, expression = WHOLE): void {
  const all = watchedOf(tab).peek();
  const isThere = all.some(
    (each) => isSameTarget(each.target, target) && each.expression === expression,
  );
  const id = all.reduce((most, each) => Math.max(most, each.id), 0) + 1;
  if (!isThere) put(tab, [...all, { id, target, expression }]);
}

export function removeWatched(tab: OpenTab, id: number): void {
  put(
    tab,
    watchedOf(tab)
      .peek()
      .filter((each) => each.id !== id),
  );
}

/** Changes the expression of a watch. */
export function changeWatched(tab: OpenTab, id: number, expression: string): void {
  const all = watchedOf(tab).peek();
  put(
    tab,
    all.map((each) => (each.id === id ? { ...each, expression } : each)),
  );
}

export function isSameTarget(one: Target, other: Target): boolean {
  return one.kind === other.kind && one.path === other.path && one.name === other.name;
}

function put(tab: OpenTab, all: readonly WatchedExpression[]): void {
  watchedOf(tab).value = all;
  const { [machineKey(tab)]: _, ...others } = keptWatches();
  const rest = Object.entries(others).slice(-MACHINES_MAX + 1);
  BROWSER_STORE.put(KEY, Object.fromEntries([...rest, [machineKey(tab), all]]));
}

/** Key under which the watches of a machine are stored. */
export function machineKey({ session, run }: OpenTab): string {
  const file = session.status.value?.summary.file ?? run.value?.now.value?.run.machine;
  return file ? `${file.project}/${file.path}` : session.id;
}

function keptWatches(): KeptWatches {
  return kept<KeptWatches>(BROWSER_STORE, KEY) ?? {};
}
