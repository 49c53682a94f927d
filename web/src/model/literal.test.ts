import { expect, test } from "vitest";
import { parseLiteral } from "./literal.ts";
import { python } from "./value.ts";

test.each([
  ["None", null],
  ["True", true],
  [" 1_000 ", 1000],
  ["-0x10", -16],
  ["9007199254740993", { __int__: "9007199254740993" }],
  ["1.5", 1.5],
  ["1.0", { __float__: "1.0" }],
  ["1e3", { __float__: "1000.0" }],
  [".5", 0.5],
  ["-inf", { __float__: "-inf" }],
  ['float("nan")', { __float__: "NaN" }],
  ["'a' \"b\"", "ab"],
  ["'\\x41\\u00e4\\n'", "A\u00e4\n"],
  ["r'\\n'", "\\n"],
  ["'''two\nlines'''", "two\nlines"],
  ["[1, [2], ]", [1, [2]]],
  ["()", { __tuple__: [] }],
  ["(1,)", { __tuple__: [1] }],
  ["(1)", 1],
  ["{}", {}],
  ["{1, 2}", { __set__: [1, 2] }],
  ["set()", { __set__: [] }],
  ["{'a': 1, 'b': {'c': ()}}", { a: 1, b: { c: { __tuple__: [] } } }],
  ["{1: 'a'}", { __dict__: [[1, "a"]] }],
  ["{'1': 'a'}", { __dict__: [["1", "a"]] }],
  ["int", { __type__: "builtins.int" }],
  ["[1, # one\n 2]", [1, 2]],
])("%s", (text, value) => {
  expect(parseLiteral(text)).toEqual({ value });
});

test.each([
  ["", "write None"],
  ["true", "True"],
  ["abc", "quotes"],
  ["[1", "] is missing"],
  ["[1 2]", "comma"],
  ["'abc", "does not end"],
  ["1 2", "unexpected text"],
  ["012", "start with 0"],
  ["1j", "complex"],
  ["open('x')", "not a literal"],
  ["{1: 2, 3}", "without a value"],
  ["[".repeat(200), "levels deep"],
])("%s is refused", (text, words) => {
  const found = parseLiteral(text);
  expect("refused" in found && found.refused).toContain(words);
});

test("what is shown can be typed again", () => {
  const values = [
    [1, 2.5, 'a"b\\c\n\u00e4', null, true],
    { a: { __tuple__: [1] }, b: { __set__: [] } },
    { __dict__: [[{ __tuple__: [1, 2] }, { __float__: "1.0" }]] },
    { __float__: "-inf" },
    { __int__: "123456789012345678901234567890" },
    { __type__: "builtins.float" },
  ];
  for (const value of values) expect(parseLiteral(python(value))).toEqual({ value });
});
