import { expect, test } from "vitest";
import { duration, growing, measured } from "./duration.ts";

test("lengths are short, and told apart where it matters", () => {
  const lengths = [0, 0.004, 1.5, 42, 400, 999, 12_300, 59_400, 59_600, 185_000, 3_723_000, -1_500];
  expect(lengths.map(duration)).toEqual([
    "0 s",
    "4 µs",
    "1.5 ms",
    "42 ms",
    "0.4 s",
    "1.0 s",
    "12 s",
    "59 s",
    "1:00",
    "3:05",
    "1:02:03",
    "−1.5 s",
  ]);
});

test("of what lasts for days, days are told", () => {
  const HOUR = 3_600_000;
  const lengths = [24 * HOUR - 1_000, 24 * HOUR, 49 * HOUR + 123_000];
  expect(lengths.map(duration)).toEqual(["23:59:59", "1 d 0:00:00", "2 d 1:02:03"]);
  expect(growing(240 * HOUR + 1_900)).toBe("10 d 0:00:01");
});

test("lengths that are compared have three figures", () => {
  const lengths = [0, 0.004, 1.046, 42.34, 251.4, 999.6, 3_420, 12_340, 59_960, 185_000, -251];
  expect(lengths.map(measured)).toEqual([
    "0 s",
    "4 µs",
    "1.05 ms",
    "42.3 ms",
    "251 ms",
    "1.00 s",
    "3.42 s",
    "12.3 s",
    "1:00",
    "3:05",
    "−251 ms",
  ]);
});

test("what still grows is told to the tenth at first, and never more than it is", () => {
  expect([0, 676, 9_990, 12_900, 185_999].map(growing)).toEqual([
    "0.0 s",
    "0.6 s",
    "9.9 s",
    "12 s",
    "3:05",
  ]);
});
