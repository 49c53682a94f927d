import { expect, test } from "vitest";
import { lengthOf, NewlyTaken, stretch } from "./pulses.ts";

const BENT = [0, 0, 10, 0, 10, 30];

function along(from: number, to: number): string {
  const found: string[] = [];
  const put = (word: string) => (x: number, y: number) => void found.push(`${word} ${x} ${y}`);
  stretch({ moveTo: put("from"), lineTo: put("to") }, BENT, from, to);
  return found.join(", ");
}

test("a light lies on its line, around corners too", () => {
  expect(lengthOf(BENT)).toBe(40);
  expect(along(2, 6)).toBe("from 2 0, to 6 0");
  expect(along(5, 20)).toBe("from 5 0, to 10 0, from 10 0, to 10 10");
  expect(along(-10, 5)).toBe("from 0 0, to 5 0");
  expect(along(41, 60)).toBe("");
});

test("what pulses was taken since the last look at the same run, and is not too much", () => {
  const taken = (...sequences: readonly number[]) =>
    new Map(
      sequences.map((sequence) => [`transition:R#${sequence}`, { sequence, isNext: false }]),
    ) as unknown as Parameters<NewlyTaken["of"]>[1];
  const news = new NewlyTaken();
  expect(news.of("one", taken(3, 4))).toEqual([]);
  expect(news.of("one", taken(4, 6))).toEqual(["transition:R#6"]);
  expect(news.of("other", taken(8, 9))).toEqual([]);
  expect(news.of("other", taken(9, 10, 11))).toHaveLength(2);
  expect(news.of("other", taken(21, 22, 23, 24, 25, 26, 27))).toEqual([]);
});
