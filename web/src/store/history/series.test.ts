import { expect, test } from "vitest";
import { POINTS_MAX, Series } from "./series.ts";

test("numbers and truths are points, all else changes", () => {
  const series = new Series();
  series.add(1, 10, 2.5);
  series.add(2, 20, true);
  series.add(3, 30, "text");
  expect(series.points.map(({ value }) => value)).toEqual([2.5, 1]);
  expect(series.changes.map(({ value }) => value)).toEqual(["text"]);
  expect([series.upTo(1)?.value, series.upTo(0), series.upTo(9)?.value]).toEqual([2.5, null, 1]);
  expect(series.beside(2, "before")?.sequence).toBe(1);
  expect(series.beside(1, "after")?.sequence).toBe(2);
});

test("what comes again as it was is no change", () => {
  const series = new Series();
  const values = ["idle", "idle", { goal: [1] }, { goal: [1] }, 4, { goal: [1] }, "idle"];
  for (const [index, value] of values.entries()) series.add(index, index, value);
  expect(series.changes.map(({ sequence }) => sequence)).toEqual([0, 2, 5, 6]);
  expect(series.count).toBe(7);
});

test("however many come, few are kept, the extremes among them, in their order", () => {
  const series = new Series();
  for (let n = 1; n <= 100_000; n += 1) series.add(n, n, n === 40_000 ? 99 : Math.sin(n));
  expect(series.points.length).toBeLessThanOrEqual(POINTS_MAX);
  expect(Math.max(...series.points.map(({ value }) => value))).toBe(99);
  expect(series.points.at(-1)?.sequence).toBe(100_000);
  const sequences = series.points.map(({ sequence }) => sequence);
  expect(sequences).toEqual([...new Set(sequences)].sort((one, other) => one - other));
  expect(series.count).toBe(100_000);
});

test("of more than a hundred changes the oldest goes, and all are counted", () => {
  const series = new Series();
  for (let n = 1; n <= 100; n += 1) series.add(n, n, `text ${n}`);
  expect(series.changes[0]?.value).toBe("text 1");
  series.add(101, 101, "text 101");
  const values = series.changes.map(({ value }) => value);
  expect([values.length, values[0], values.at(-1)]).toEqual([100, "text 2", "text 101"]);
  expect(series.count).toBe(101);
});
