import { expect, test } from "vitest";
import { readDefault, textOfDefault } from "./default_text.ts";

test("defaults are read as people type them", () => {
  expect(readDefault("[1, 2]", "list")).toEqual({ value: [1, 2] });
  expect(readDefault(" $speed ", "float")).toEqual({ value: "$speed" });
  expect(readDefault("", "int")).toEqual({ value: null });
  expect(readDefault("", "str")).toEqual({ value: "" });
  expect(readDefault("hello world", "str")).toEqual({ value: "hello world" });
  expect(readDefault('"hello"', "str")).toEqual({ value: "hello" });
  expect(readDefault("5", "str")).toEqual({ value: "5" });
  expect(readDefault("None", "str")).toEqual({ value: null });
  expect(readDefault("hello", "int")).toHaveProperty("refused");
});

test("a default that is shown is read as the same", () => {
  for (const value of ["a", "5", "None", '"', "$place", "two\nlines", null])
    expect(readDefault(textOfDefault(value), "str")).toEqual({ value });
});
