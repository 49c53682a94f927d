import { expect, test } from "vitest";
import type { ActiveState, RunNow, RunStatus, RunSummary } from "./generated/protocol.ts";
import { holdInWords, runStatusWords, statusInWords, summaryStatusWords } from "./run_words.ts";

const SUMMARY = {
  id: "drill-1",
  name: "Drill",
  machine: null,
  author: "anna",
  started_ms: 0,
  length_ms: 10,
  events: 4,
  bytes: 100,
  keeping: "full",
  waits: null,
} as const;

const ACTIVE: ActiveState = {
  path: "R/A",
  name: "A",
  phase: "running",
  since_ms: 1,
  branch: "",
  detail: null,
  held: [],
};

function live(
  status: RunStatus,
  active: readonly Partial<ActiveState>[],
  asks: readonly string[] = [],
): RunNow {
  return {
    run: { ...SUMMARY, phase: "live" },
    snapshot: {
      status,
      active: active.map((state) => ({ ...ACTIVE, ...state })),
      journal_problem: null,
      questions: asks.map((path, id) => ({ id, path })),
    },
  } as unknown as RunNow;
}

function inShort(now: RunNow): string {
  return statusInWords(runStatusWords(now));
}

test("a run that is over says by which outcome, and one that failed looks so", () => {
  const ended = (id: number, name: string): RunSummary => ({
    ...SUMMARY,
    phase: "finished",
    outcome: { id, name },
    states_run: 3,
  });
  expect(summaryStatusWords(ended(0, "success"))).toEqual({
    word: "finished",
    tone: "plain",
    detail: "success",
  });
  expect(summaryStatusWords(ended(-1, "aborted")).tone).toBe("aborted");
  expect(summaryStatusWords(ended(-2, "preempted")).tone).toBe("preempted");
  expect(summaryStatusWords({ ...SUMMARY, phase: "crashed" }).word).toBe("crashed");
});

test("a run waits only if nothing of it is at work", () => {
  const waits = { path: "R/W", phase: "waiting", detail: "a transition" } as const;
  const root = { path: "R" } as const;
  expect(inShort(live("running", [root, waits]))).toBe("waiting for a transition");
  expect(inShort(live("running", [root, waits, {}]))).toBe("running");
  expect(inShort(live("stepping", [{ phase: "interrupted" }, {}]))).toMatch(
    /^waiting for a decision/,
  );
});

test("a run whose only branch has asked waits for an answer, also while its script runs", () => {
  const asks = { path: "R/A", phase: "running" } as const;
  expect(inShort(live("running", [{ path: "R" }, asks], ["R/A"]))).toBe("waiting for an answer");
  expect(inShort(live("running", [{ path: "R" }, asks, { path: "R/B" }], ["R/A"]))).toBe("running");
  const line = (waits: RunSummary["waits"]) =>
    statusInWords(summaryStatusWords({ ...SUMMARY, phase: "live", waits }));
  expect([line(null), line("answer"), line("decision"), line("paused"), line("other")]).toEqual([
    "running",
    "waiting for an answer",
    "waiting for a decision after the crash",
    "paused",
    "waiting",
  ]);
});

test("what is held says by what, each reason once", () => {
  const by = { type: "breakpoint", id: 3 } as const;
  const held = [{ next: "R/B", by }];
  expect(inShort(live("stepping", [{ held }, { held }]))).toBe("stepping: breakpoint 3");
  const step = [{ next: "R/B", by: { type: "step" } as const }];
  const loss = [{ next: null, by: { type: "loss", loss: "link" } as const }];
  expect(inShort(live("stepping", [{ held: loss }]))).toBe(
    "paused: no signal from the ground; resume to continue",
  );
  expect(inShort(live("stepping", [{ held: step }]))).toBe("stepping");
  expect(holdInWords({ type: "start" })).toBe("paused at the start");
});
