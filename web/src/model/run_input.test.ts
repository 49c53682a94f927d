import { expect, test } from "vitest";
import { readInput } from "./run_input.ts";

test.each([
  ["3", "int", 3],
  ["2.5", "float", 2.5],
  ["3.0", "float", { __float__: "3.0" }],
  ["-0.0", "float", { __float__: "-0.0" }],
  ["nan", "float", { __float__: "NaN" }],
  ["99999999999999999999", "int", { __int__: "99999999999999999999" }],
  ["red", "str", "red"],
  ["", "float", null],
  ["(1, 2)", "tuple", { __tuple__: [1, 2] }],
  ["{1, 2}", "set", { __set__: [1, 2] }],
  ["{1: (True,)}", "dict", { __dict__: [[1, { __tuple__: [true] }]] }],
  ["{'1': 2}", "dict", { __dict__: [["1", 2]] }],
  ["{'a': 2}", "dict", { a: 2 }],
])("%s for a %s", (text, type, value) => {
  expect(readInput(text, type)).toEqual({ value });
});

test("a global variable is refused", () => {
  expect(readInput("$speed", "int")).toEqual({
    refused: expect.stringMatching(/global variable/),
  });
  expect(readInput("true", "bool")).toEqual({ refused: expect.stringMatching(/True/) });
});
