import { expect, test } from "vitest";
import { agePhrase } from "./age.ts";

test("an age is as exact as one needs it", () => {
  expect([0, 59_400, 61_000, 3_700_000, 200_000_000].map(agePhrase)).toEqual([
    "0 s",
    "59 s",
    "1 min 1 s",
    "1 h 1 min",
    "2 days",
  ]);
});
