import { expect, test } from "vitest";
import { freshId, freshName, freshNumber, numberedName } from "./names.ts";
import { defaultOf, fits, isTypeName, valueFits } from "./types.ts";

test("types fit as the server says", () => {
  expect(fits("int", "builtins.int")).toBe(true);
  expect(fits("bool", "int")).toBe(true);
  expect(fits("int", "float")).toBe(false);
  expect(fits("int", "bool")).toBe(false);
  expect(fits("str", "object")).toBe(true);
  expect(fits("object", "str")).toBe(true);
  expect(fits("numpy.ndarray", "list")).toBe(true);
});

test("each default fits its type", () => {
  for (const type of ["int", "float", "bool", "str", "list", "dict", "tuple", "set", "object"]) {
    expect(valueFits(defaultOf(type), type)).toBe(true);
  }
  expect(valueFits(0, "list")).toBe(false);
  expect(valueFits("[1, 2]", "list")).toBe(true);
  expect(valueFits("one", "int")).toBe(false);
  expect(valueFits("$speed", "int")).toBe(true);
  expect(valueFits({ __float__: "1.0" }, "int")).toBe(false);
  expect(valueFits(3, "numpy.int64")).toBe(true);
});

test("types have dotted names", () => {
  expect(isTypeName("numpy.ndarray")).toBe(true);
  expect(isTypeName("list[int]")).toBe(false);
  expect(isTypeName("")).toBe(false);
});

test("free names and ids", () => {
  expect(freshName("a", ["b"])).toBe("a");
  expect(freshName("a", ["a", "a_0"])).toBe("a_1");
  expect(numberedName("input", ["input_0"])).toBe("input_1");
  expect(freshNumber([{ id: 0 }, { id: 2 }])).toBe(1);
  expect(freshId((id) => id.startsWith("A"))).toMatch(/^[B-Z][A-Z]{5}$/);
});
