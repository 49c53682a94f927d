import { expect, test } from "vitest";
import { fitted, panned, spanOf, ticks, withTime, zoomed } from "./span.ts";

const END = 100e9;

test("all shows until someone zooms, and all again when there is no more", () => {
  expect(spanOf(null, END)).toEqual({ from_ns: 0, to_ns: 102e9 });
  const closer = zoomed(spanOf(null, END), 0.5, 20e9, END);
  const { from_ns, to_ns } = spanOf(closer, END);
  expect(to_ns - from_ns).toBeCloseTo(51e9);
  expect((20e9 - from_ns) / (to_ns - from_ns)).toBeCloseTo(20 / 102);
  expect(zoomed(spanOf(closer, END), 4, 20e9, END)).toBeNull();
});

test("at its end the part goes along with the run, elsewhere it stays", () => {
  const atEnd = panned(spanOf(zoomed(spanOf(null, END), 0.1, 50e9, END), END), 1e12, END);
  expect(atEnd?.isFollowing).toBe(true);
  expect(spanOf(atEnd, 2 * END).to_ns).toBe(204e9);
  const back = panned(spanOf(atEnd, END), -5e9, END);
  expect(back?.isFollowing).toBe(false);
  expect(spanOf(back, 2 * END)).toEqual(spanOf(back, END));
  expect(panned(spanOf(back, END), -1e12, END)?.from_ns).toBe(0);
});

test("a part is fitted with room, and moved only if a time does not show", () => {
  const part = fitted({ from_ns: 40e9, to_ns: 50e9 }, END);
  expect(part).toMatchObject({ from_ns: 39e9, to_ns: 51e9 });
  expect(withTime(part, 45e9, END)).toBe(part);
  expect(spanOf(withTime(part, 80e9, END), END)).toMatchObject({ from_ns: 74e9, to_ns: 86e9 });
});

test("marks of the ruler stand at round times", () => {
  expect(ticks({ from_ns: 0, to_ns: 1e9 }, 10)).toMatchObject({ step_ms: 100 });
  expect(ticks({ from_ns: 0.95e9, to_ns: 2.05e9 }, 3).at_ns).toEqual([1e9, 1.5e9, 2e9]);
  expect(ticks({ from_ns: 0, to_ns: 3_600e9 }, 8).step_ms).toBe(600_000);
});
