/** Breakpoints of a machine: those of its active run, otherwise those stored in this browser for the next start. */

import { type Signal, signal } from "@preact/signals-core";
import type { Breakpoint } from "../../model/generated/protocol.ts";
import { perOwner } from "../../model/per_owner.ts";
import { BROWSER_STORE, type LocalStore } from "../local_store.ts";
import type { OpenTab } from "../page/page.ts";
import { fileOfTab, liveRun, snapshotOf } from "./running.ts";

type KeptBreakpoints = Signal<readonly Breakpoint[]>;

const keptIn = perOwner((_localStore: LocalStore) => new Map<string, KeptBreakpoints>());

/** Breakpoints for the next start of a tab's machine. */
export function keptBreakpoints(
  tab: OpenTab,
  localStore: LocalStore = BROWSER_STORE,
): KeptBreakpoints {
  const known = keptIn(localStore);
  const key = keyOf(tab);
  let kept = known.get(key);
  if (!kept) {
    kept = followingStore(localStore, key);
    known.set(key, kept);
  }
  return kept;
}

/** Stored breakpoints: written when they change here, and read when another tab of the browser changes them. */
function followingStore(localStore: LocalStore, key: string): KeptBreakpoints {
  const there = () => {
    const found = localStore.get(key);
    return Array.isArray(found) ? (found as readonly Breakpoint[]) : [];
  };
  const kept = signal(there());
  kept.subscribe((all) => localStore.put(key, all.length === 0 ? undefined : all));
  localStore.whenOther(key, () => {
    kept.value = there();
  });
  return kept;
}

function keyOf(tab: OpenTab): string {
  const file = fileOfTab(tab);
  return `rafcon.breakpoints ${file ? `${file.project}/${file.path}` : tab.session.id}`;
}

const NONE: readonly Breakpoint[] = [];

/** Breakpoints in effect on a tab. Reads signals. */
export function breakpointsOf(
  tab: OpenTab,
  localStore: LocalStore = BROWSER_STORE,
): readonly Breakpoint[] {
  const live = liveRun(tab);
  if (live) return snapshotOf(live)?.breakpoints ?? NONE;
  return keptBreakpoints(tab, localStore).value;
}

/** The list with the breakpoint added, or replaced by id. */
export function withBreakpoint(
  all: readonly Breakpoint[],
  breakpoint: Breakpoint,
): readonly Breakpoint[] {
  const others = all.filter(({ id }) => id !== breakpoint.id);
  return [...others, breakpoint].sort((one, other) => one.id - other.id);
}

/** An id that no breakpoint of the run or of the next start has. */
export function freshId(tab: OpenTab, localStore: LocalStore = BROWSER_STORE): number {
  const live = liveRun(tab);
  const all = [
    ...(snapshotOf(live)?.breakpoints ?? []),
    ...keptBreakpoints(tab, localStore).peek(),
  ];
  return 1 + all.reduce((most, { id }) => Math.max(most, id), 0);
}

/** A plain breakpoint before a state. */
export function newBreakpoint(id: number, path: string): Breakpoint {
  return {
    id,
    path,
    when: "before",
    condition: null,
    hit_count: 0,
    scope: "branch",
    unattended: "hold",
    enabled: true,
  };
}
