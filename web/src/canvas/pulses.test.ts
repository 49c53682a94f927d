import { expect, test } from "vitest";
import { lengthOf, stretch } from "./pulses.ts";

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
