import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Breakpoint } from "../../model/generated/protocol.ts";
import { memoryStore } from "../local_store.ts";
import type { OpenTab } from "../page/page.ts";
import {
  breakpointsOf,
  freshId,
  keptBreakpoints,
  newBreakpoint,
  withBreakpoint,
} from "./breakpoints.ts";

function tabWith(path: string, ofRun: readonly Breakpoint[] | null = null): OpenTab {
  const now = { run: { phase: "live" }, snapshot: { breakpoints: ofRun } };
  const summary = { file: { project: "p", path } };
  return {
    session: { id: "m", status: signal({ summary }) },
    run: signal(ofRun && { now: signal(now) }),
  } as unknown as OpenTab;
}

test("breakpoints are kept for each machine, and are there again", () => {
  const localStore = memoryStore();
  const kept = keptBreakpoints(tabWith("drill"), localStore);
  kept.value = [newBreakpoint(1, "R/A")];
  expect(breakpointsOf(tabWith("drill"), localStore)).toEqual([newBreakpoint(1, "R/A")]);
  expect(breakpointsOf(tabWith("mill"), localStore)).toEqual([]);
  expect(localStore.get("rafcon.breakpoints p/drill")).toHaveLength(1);
  kept.value = [];
  expect(localStore.get("rafcon.breakpoints p/drill")).toBeUndefined();
});

test("what another tab of the browser does to them is told", () => {
  const localStore = memoryStore();
  const others = new Map<string, () => void>();
  const here = {
    ...localStore,
    whenOther: (key: string, listener: () => void) => others.set(key, listener),
  };
  const [mine, theirs] = [
    keptBreakpoints(tabWith("drill"), here),
    keptBreakpoints(tabWith("drill"), localStore),
  ];
  theirs.value = [newBreakpoint(1, "R/A")];
  others.get("rafcon.breakpoints p/drill")?.();
  expect(mine.value).toEqual([newBreakpoint(1, "R/A")]);
  theirs.value = [];
  others.get("rafcon.breakpoints p/drill")?.();
  expect(mine.value).toEqual([]);
});

test("while a run continues its breakpoints count, and new ones have a number that is free in both", () => {
  const localStore = memoryStore();
  const tab = tabWith("drill", [newBreakpoint(4, "R/B")]);
  keptBreakpoints(tab, localStore).value = [newBreakpoint(6, "R/A")];
  expect(breakpointsOf(tab, localStore).map(({ id }) => id)).toEqual([4]);
  expect(freshId(tab, localStore)).toBe(7);
});

test("a breakpoint replaces the one with its number", () => {
  const [one, two] = [newBreakpoint(1, "R/A"), newBreakpoint(2, "R/B")];
  const off = { ...one, enabled: false };
  expect(withBreakpoint([one, two], off)).toEqual([off, two]);
});
