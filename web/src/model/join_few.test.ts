import { expect, test } from "vitest";
import { joinFew } from "./join_few.ts";

test("many names are told by the first ones and their number", () => {
  expect(joinFew([])).toBe("");
  expect(joinFew(["A", "B", "C"])).toBe("“A”, “B”, “C”");
  expect(joinFew(["A", "B", "C", "D", "E"])).toBe("“A”, “B” and 3 more");
});
