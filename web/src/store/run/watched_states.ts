/** States that the user watches with everything inside them, by machine. Stored in this browser. */

import { type Signal, signal } from "@preact/signals-core";
import { BROWSER_STORE, kept } from "../local_store.ts";
import type { OpenTab } from "../page/page.ts";
import { machineKey } from "./watched_values.ts";

const KEY = "rafcon.watched_states";
const MACHINES_MAX = 50;

type KeptStates = Readonly<Record<string, readonly string[]>>;

const known = new Map<string, Signal<readonly string[]>>();

/** Paths of the watched states of a tab's machine. Runs of one machine share them. */
export function watchedStatesOf(tab: OpenTab): Signal<readonly string[]> {
  const key = machineKey(tab);
  let found = known.get(key);
  if (!found) {
    found = signal(keptStates()[key] ?? []);
    known.set(key, found);
  }
  return found;
}

/** Adds a state to the watched ones, or removes it. */
export function setStateWatched(tab: OpenTab, path: string, isWatched: boolean): void {
  const all = watchedStatesOf(tab);
  const others = all.peek().filter((each) => each !== path);
  all.value = isWatched ? [...others, path] : others;
  const { [machineKey(tab)]: _, ...machines } = keptStates();
  const rest = Object.entries(machines).slice(-MACHINES_MAX + 1);
  BROWSER_STORE.put(KEY, Object.fromEntries([...rest, [machineKey(tab), all.peek()]]));
}

function keptStates(): KeptStates {
  return kept<KeptStates>(BROWSER_STORE, KEY) ?? {};
}
