import { expect, test } from "vitest";
import { shortValue } from "./short_value.ts";

test.each([
  [null, "None"],
  [true, "True"],
  [3, "3"],
  [3.14, "3.14"],
  [1 / 3, "0.333333"],
  ["red", '"red"'],
  ["a longer text than a chip has room for", '"a longer text than a …"'],
  ["two\nlines", '"two lines"'],
  [[1, 2, 3], "[1, 2, 3]"],
  [[], "[]"],
  [{ __tuple__: [1] }, "(1,)"],
  [{ x: 1, y: 2 }, "{x: 1, y: 2}"],
  [{ position: [0.1, 0.2, 0.3], frame: "map" }, "dict ⟨2⟩"],
  [Array(40).fill(0), "list ⟨40⟩"],
  [{ __repr__: "nan", __class__: "float" }, "nan"],
  [{ __repr__: "18446744073709551616", __class__: "int" }, "18446744073709551616"],
  [{ __repr__: "list of 1000", __class__: "list", __len__: 1000, __first__: [0] }, "list ⟨1000⟩"],
  [{ __repr__: "dict of 300", __class__: "dict", __len__: 300, __some__: { a: 1 } }, "dict ⟨300⟩"],
  [{ __repr__: "x".repeat(200), __class__: "str", __len__: 5000 }, `"${"x".repeat(21)}…"`],
  [{ __exc__: "KeyError", msg: "'a'" }, "KeyError: 'a'"],
  [{ __type__: "builtins.int" }, "int"],
  [{ __repr__: "<Arm>", __class__: "Arm" }, "<Arm>"],
  [{ __float__: "1.0" }, "1.0"],
])("%j is %s", (value, short) => {
  expect(shortValue(value)).toBe(short);
});

test("arrays by their numbers if these are few, else by type and shape", () => {
  const array = { __repr__: "array(…)", __class__: "ndarray", __dtype__: "float64" };
  const elements = {
    ...array,
    __shape__: [3],
    __items__: [1, 2.5, { __repr__: "nan", __class__: "float" }],
  };
  expect(shortValue(elements)).toBe("[1, 2.5, nan]");
  const many = { ...array, __shape__: [480, 640], __items__: [0, 0, 0, 0], __sampled__: [2, 2] };
  expect(shortValue(many)).toBe("float64 ⟨480×640⟩");
  expect(shortValue({ ...array, __shape__: [], __items__: [2.5] })).toBe("2.5");
  expect(shortValue({ ...array, __shape__: [9] })).toBe("float64 ⟨9⟩");
});
