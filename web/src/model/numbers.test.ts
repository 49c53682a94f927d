import { expect, test } from "vitest";
import { isColoured, numbersOf, range, recordsOf } from "./numbers.ts";
import { read } from "./wire.ts";

const ARRAY = { __repr__: "…", __class__: "ndarray", __dtype__: "uint8", __shape__: [4, 6, 3] };

test("numbers of lists, of lists of lists and of arrays", () => {
  expect(numbersOf(read([1, 2.5]))).toMatchObject({ items: [1, 2.5], shape: [2] });
  expect(numbersOf(read([[1, 2], { __tuple__: [3, 4] }]))).toMatchObject({ shape: [2, 2] });
  const sampled = { __items__: Array(18).fill(7), __sampled__: [2, 3, 3], __steps__: [2, 2, 1] };
  const numbers = numbersOf(read({ ...ARRAY, ...sampled }));
  expect(numbers).toMatchObject({ shape: [2, 3, 3], steps: [2, 2, 1] });
  expect(numbers && isColoured(numbers)).toBe(true);
});

test.each([[[1]], [[1, "x"]], [[[1, 2], [3]]], [ARRAY], ["text"], [{ __set__: [1, 2] }]])(
  "%j has no numbers in rows",
  (value) => {
    expect(numbersOf(read(value))).toBeNull();
  },
);

test("what is not finite does not stretch the range", () => {
  expect(range([2, Number.NaN, -1, Number.POSITIVE_INFINITY])).toEqual([-1, 2]);
  expect(range([Number.NaN])).toBeNull();
});

test("dicts that share a key are records", () => {
  const records = recordsOf(read([{ a: 1, b: 2 }, { a: 3 }]));
  expect(records?.keys).toEqual(["a", "b"]);
  expect(recordsOf(read([{ a: 1 }, { b: 2 }]))).toBeNull();
  expect(recordsOf(read([{ a: 1 }, 2]))).toBeNull();
});
