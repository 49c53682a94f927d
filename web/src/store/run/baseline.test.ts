import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { RunSummary } from "../../model/generated/protocol.ts";
import { Counts, LENGTHS_MAX } from "../history/counts.ts";
import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import {
  type Baseline,
  baselineOf,
  earlierRuns,
  expectedLength,
  isLongerThanEver,
  pastBaselines,
  usualInWords,
} from "./baseline.ts";

const SECONDS = (ms: number) => `${ms / 1_000} s`;

/** Baseline after the state took these numbers of seconds. */
function baseline(seconds: readonly number[], past: Baseline | null = null): Baseline | null {
  const counts = new Counts();
  for (const length of seconds) {
    counts.entered(1, "R/A", 0, false);
    counts.left(1, "R/A", length * 1e9, { id: 0, name: "success" }, false);
  }
  const before = new Map(past ? [["R/A", past]] : []);
  return baselineOf({ journal: { counts } } as unknown as Watch, before, "R/A");
}

function words(seconds: readonly number[], past: Baseline | null = null): string {
  const found = baseline(seconds, past);
  return found ? usualInWords(found, SECONDS) : "";
}

test("usually is the median from five times on, which one long time does not move", () => {
  expect(words([1, 1, 2, 1, 600])).toBe("usually 1 s, at most 600 s (5 times)");
  expect(words([1, 2, 9])).toBe("on average 4 s, at most 9 s (3 times)");
  expect(words([3])).toBe("3 s the one time before");
  expect(words([])).toBe("");
});

test("what is usual follows the last times", () => {
  const all = [...Array<number>(40).fill(1), ...Array<number>(LENGTHS_MAX).fill(7)];
  expect(words(all)).toBe("usually 7 s, at most 7 s (71 times)");
});

test("earlier runs count until this one has run often enough", () => {
  const past = { typical_ms: 8_000, isMedian: true, max_ms: 9_000, count: 12 };
  expect(words([1, 1], past)).toBe("usually 8 s, at most 9 s (12 times)");
  expect(words([1, 1, 1, 1, 1], past)).toBe("usually 1 s, at most 1 s (5 times)");
});

test("a run usually takes the median of five earlier ones, and below that their mean", () => {
  const of = (...seconds: readonly number[]) =>
    expectedLength(seconds.map((length) => ({ length_ms: length * 1_000 })));
  expect(of()).toBe(null);
  expect(of(1, 2, 6)).toEqual({ length_ms: 3_000, isMedian: false });
  expect(of(1, 1, 2, 9, 60)).toEqual({ length_ms: 2_000, isMedian: true });
});

test("longer than ever needs five times, and is never said of what waits", () => {
  const is = (times: number, phase: "running" | "waiting" | "held", since_ms: number) => {
    const found = baseline(Array<number>(times).fill(2));
    return found !== null && isLongerThanEver({ phase }, found, since_ms);
  };
  expect([is(5, "running", 3_500), is(5, "running", 2_900)]).toEqual([true, false]);
  expect([is(4, "running", 99_000), is(5, "waiting", 99_000), is(5, "held", 99_000)]).toEqual([
    false,
    false,
    false,
  ]);
});

test("an earlier run is asked for once, and again after fifty others", () => {
  const asked: string[] = [];
  const get = (run: string) => {
    asked.push(run);
    return Promise.resolve({ states: [] });
  };
  const page = { runs: { get } } as unknown as Page;
  pastBaselines(page, "first");
  pastBaselines(page, "first");
  for (let run = 0; run < 49; run += 1) pastBaselines(page, `other-${run}`);
  pastBaselines(page, "first");
  expect(asked.filter((run) => run === "first")).toHaveLength(1);
  for (let run = 0; run < 50; run += 1) pastBaselines(page, `more-${run}`);
  pastBaselines(page, "first");
  expect(asked.filter((run) => run === "first")).toHaveLength(2);
});

test("of earlier runs the newest twenty count", () => {
  const file = { project: "p", path: "arm" };
  const line = (id: number) => {
    const outcome = { id: 0, name: "success" };
    return { id: `${id}`, started_ms: id, phase: "finished", machine: file, outcome };
  };
  const earlier = (count: number) => {
    const all = Array.from({ length: count + 1 }, (_, at) => line(count - at));
    const page = { runs: { all: signal(all) } } as unknown as Page;
    const run = all[0] as unknown as RunSummary;
    const watch = { id: run.id, now: signal({ run }) } as unknown as Watch;
    const found = earlierRuns(page, watch);
    return [found.length, found[0]?.id, found.at(-1)?.id];
  };
  expect(earlier(20)).toEqual([20, "19", "0"]);
  expect(earlier(21)).toEqual([20, "20", "1"]);
});
