import { expect, test } from "vitest";
import { growth } from "./memory.ts";

test("growth is that of the last third over the first, whatever a single value says", () => {
  expect(growth([100, 100, 900, 5, 5, 5, 110, 110, 1])).toBeCloseTo(10);
  expect(growth([100, 100])).toBe(0);
});
