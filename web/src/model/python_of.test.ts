import { expect, test } from "vitest";
import { pythonOf } from "./python_of.ts";

test.each([
  [{ a: [1, { __tuple__: [2, null] }], b: "x\n" }, '{"a": [1, (2, None)], "b": "x\\n"}'],
  [{ __repr__: "-inf", __class__: "float" }, 'float("-inf")'],
  [{ __repr__: "list of 9", __class__: "list", __len__: 9, __first__: [1, 2] }, "[1, 2, ...]"],
  [{ __exc__: "ValueError", msg: "no" }, 'ValueError("no")'],
  [{ __repr__: "<Arm>", __class__: "Arm" }, "<Arm>"],
])("%j is %s", (value, python) => {
  expect(pythonOf(value)).toBe(python);
});

test("an array is made again in its shape, with a word on what was left out", () => {
  const array = { __repr__: "…", __class__: "ndarray", __dtype__: "float64", __shape__: [2, 2] };
  const nan = { __repr__: "nan", __class__: "float" };
  expect(pythonOf({ ...array, __items__: [1, 2.5, nan, 4] })).toBe(
    'numpy.array([[1, 2.5], [numpy.nan, 4]], dtype="float64")',
  );
  const some = { __shape__: [4], __items__: [1, 3], __sampled__: [2], __steps__: [2] };
  expect(pythonOf({ ...array, ...some })).toBe(
    'numpy.array([1, 3], dtype="float64")  # every 2 of 4',
  );
});
