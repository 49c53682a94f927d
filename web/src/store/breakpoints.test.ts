import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Breakpoint } from "../model/generated/protocol.ts";
import {
  breakpointsOf,
  freshId,
  keptBreakpoints,
  newBreakpoint,
  withBreakpoint,
} from "./breakpoints.ts";
import type { OpenTab } from "./page.ts";
import { memoryShed } from "./shed.ts";

function tabWith(path: string, ofRun: readonly Breakpoint[] | null = null): OpenTab {
  const now = { run: { phase: "live" }, snapshot: { breakpoints: ofRun } };
  const summary = { file: { project: "p", path } };
  return {
    session: { id: "m", status: signal({ summary }) },
    run: signal(ofRun && { now: signal(now) }),
  } as unknown as OpenTab;
}

test("breakpoints are kept for each machine, and are there again", () => {
  const shed = memoryShed();
  const kept = keptBreakpoints(tabWith("drill"), shed);
  kept.value = [newBreakpoint(1, "R/A")];
  expect(breakpointsOf(tabWith("drill"), shed)).toEqual([newBreakpoint(1, "R/A")]);
  expect(breakpointsOf(tabWith("mill"), shed)).toEqual([]);
  expect(shed.get("rafcon.breakpoints p/drill")).toHaveLength(1);
  kept.value = [];
  expect(shed.get("rafcon.breakpoints p/drill")).toBeUndefined();
});

test("what another tab of the browser does to them is told", () => {
  const shed = memoryShed();
  const others = new Map<string, () => void>();
  const here = { ...shed, whenOther: (key: string, told: () => void) => others.set(key, told) };
  const [mine, theirs] = [
    keptBreakpoints(tabWith("drill"), here),
    keptBreakpoints(tabWith("drill"), shed),
  ];
  theirs.value = [newBreakpoint(1, "R/A")];
  others.get("rafcon.breakpoints p/drill")?.();
  expect(mine.value).toEqual([newBreakpoint(1, "R/A")]);
  theirs.value = [];
  others.get("rafcon.breakpoints p/drill")?.();
  expect(mine.value).toEqual([]);
});

test("while a run goes on its breakpoints count, and new ones have a number that is free in both", () => {
  const shed = memoryShed();
  const tab = tabWith("drill", [newBreakpoint(4, "R/B")]);
  keptBreakpoints(tab, shed).value = [newBreakpoint(6, "R/A")];
  expect(breakpointsOf(tab, shed).map(({ id }) => id)).toEqual([4]);
  expect(freshId(tab, shed)).toBe(7);
});

test("a breakpoint replaces the one with its number", () => {
  const [one, two] = [newBreakpoint(1, "R/A"), newBreakpoint(2, "R/B")];
  const off = { ...one, enabled: false };
  expect(withBreakpoint([one, two], off)).toEqual([off, two]);
});
