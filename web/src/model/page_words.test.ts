import { expect, test } from "vitest";
import { inPageWords } from "./page_words.ts";

test.each([
  [
    "no library root fits `generic/wait`: /api/v1/libraries lists them",
    "no library root fits `generic/wait`",
  ],
  ["there is no run `x`: GET /api/v1/runs lists them", "there is no run `x`"],
  [
    "the engine `a` has found no plan within 10 s: give it more time (`--time-limit`), or fewer objects",
    "the engine `a` has found no plan within 10 s: give it more time, or fewer objects",
  ],
  ["Bob is in control.", "Bob is in control."],
])("%s", (message, expected) => {
  expect(inPageWords(message)).toBe(expected);
});
