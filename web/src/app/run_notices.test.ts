import { expect, test } from "vitest";
import type { RunFailure } from "../store/history/failures.ts";
import { failuresInWords, failuresSince, LongerAlarms, longerInWords } from "./run_notices.ts";

const at = (sequence: number, some: Partial<RunFailure>): RunFailure => ({
  sequence,
  first: sequence,
  t_ns: 0,
  kind: "aborted",
  level: "error",
  path: "R/A",
  text: "",
  reach: "R/A",
  count: 1,
  ...some,
});

test("warnings, crashes and what is known are not told", () => {
  const all = [
    at(1, {}),
    at(5, { kind: "log", level: "warning" }),
    at(6, { kind: "crash" }),
    at(7, { kind: "log" }),
    at(8, {}),
  ];
  expect(failuresSince(all, 5).map(({ sequence }) => sequence)).toEqual([7, 8]);
});

test("the newest failure is told, with how many there are", () => {
  const failure = at(1, { text: "NoPath: none" });
  expect(failuresInWords(failure, 1, "Plan")).toBe("Plan aborted: NoPath: none");
  expect(failuresInWords(failure, 3, "Plan")).toBe(
    "3 failures, the latest: Plan aborted: NoPath: none",
  );
  expect(failuresInWords(at(1, { kind: "log", text: "no link" }), 1, "Plan")).toBe("Plan: no link");
});

test("a state that takes longer than ever is told with what was usual", () => {
  const baseline = { typical_ms: 3_000, isMedian: true, max_ms: 5_000, count: 14 };
  expect(longerInWords("Drill", { since_ms: 12_000, baseline })).toBe(
    "Drill has run longer than ever before: 12 s, usually 3.0 s, at most 5.0 s (14 times)",
  );
});

test("an alarm is due once, at the second reading of the clock, and again only after its state has ended", () => {
  const drill = {
    path: "R/A",
    since_ms: 9_000,
    baseline: { typical_ms: 1, isMedian: true, max_ms: 1, count: 9 },
  };
  const alarms = new LongerAlarms();
  const due = (all: readonly (typeof drill)[] | null, now_ms: number) =>
    alarms.due(all, now_ms).length;
  expect([due([drill], 1_000), due([drill], 1_000)]).toEqual([0, 0]);
  expect([due([drill], 2_000), due([drill], 3_000), due(null, 4_000), due([drill], 5_000)]).toEqual(
    [1, 0, 0, 0],
  );
  expect([due([], 6_000), due([drill], 7_000), due([drill], 8_000)]).toEqual([0, 0, 1]);
});

test("what ends with the first reading after a silence gives no alarm", () => {
  const drill = {
    path: "R/A",
    since_ms: 9_000,
    baseline: { typical_ms: 1, isMedian: true, max_ms: 1, count: 9 },
  };
  const alarms = new LongerAlarms();
  expect(
    [alarms.due([drill], 1_000), alarms.due([], 1_000), alarms.due([drill], 2_000)].flat(),
  ).toEqual([]);
});
