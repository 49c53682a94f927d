import { expect, test } from "vitest";
import { fewInWords } from "./few.ts";

test("many names are told by the first ones and their number", () => {
  expect(fewInWords([])).toBe("");
  expect(fewInWords(["A", "B", "C"])).toBe("“A”, “B”, “C”");
  expect(fewInWords(["A", "B", "C", "D", "E"])).toBe("“A”, “B” and 3 more");
});
