import { expect, test } from "vitest";
import { Delay } from "./delay.ts";

test("of more than a hundred questions without an answer the first one is forgotten", () => {
  const delay = new Delay();
  for (let question = 1; question <= 101; question += 1) delay.ask(0);
  expect([delay.answer(1, 0, 5), delay.answer(2, 0, 5), delay.answer(101, 0, 5)]).toEqual([
    null,
    5,
    5,
  ]);
});

test("clocks are compared by the quickest of the last eight answers", () => {
  const delay = new Delay();
  const answer = (round_ms: number, server_ms: number) => {
    delay.answer(delay.ask(0), server_ms, round_ms);
    return delay.ahead_ms;
  };
  expect(answer(0, 100)).toBe(100);
  const later = Array.from({ length: 8 }, () => answer(10, 505));
  expect(later).toEqual([100, 100, 100, 100, 100, 100, 100, 500]);
});

test("a dial may take two minutes at most, however many had no answer", () => {
  const unmeasured = new Delay();
  expect([0, 1, 2, 3, 100].map((count) => unmeasured.dial_ms(count))).toEqual([
    30_000, 60_000, 120_000, 120_000, 120_000,
  ]);
  const measured = new Delay();
  measured.answer(measured.ask(0), 0, 0);
  expect([0, 3, 7, 11, 15, 103].map((count) => measured.dial_ms(count))).toEqual([
    20_000, 40_000, 80_000, 120_000, 120_000, 120_000,
  ]);
});
