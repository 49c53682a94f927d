import { expect, test } from "vitest";
import { readInput } from "./run_input.ts";

test.each([
  ["3", "int", 3],
  ["2.5", "float", 2.5],
  ["3.0", "float", 3],
  ["red", "str", "red"],
  ["", "float", null],
  ["(1, 2.0)", "tuple", { __jsonqualname__: "__builtin__.tuple", items: [1, 2] }],
  ["{1, 2}", "set", { __jsonqualname__: "__builtin__.set", items: [1, 2] }],
  ["{1: (True,)}", "dict", { "1": { __jsonqualname__: "__builtin__.tuple", items: [true] } }],
])("%s for a %s", (text, type, value) => {
  expect(readInput(text, type)).toEqual({ value });
});

test.each([
  ["$speed", "int", /global variable/],
  ["true", "bool", /True/],
  ["nan", "float", /cannot be given/],
  ["99999999999999999999", "int", /too large/],
  ["{'1': 2}", "dict", /whole numbers/],
  ["{1.5: 2}", "dict", /whole numbers/],
])("%s for a %s is refused", (text, type, why) => {
  expect(readInput(text, type)).toEqual({ refused: expect.stringMatching(why) });
});
