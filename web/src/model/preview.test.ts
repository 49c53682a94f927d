import { expect, test } from "vitest";
import { previewValue } from "./preview.ts";

const POSE = { frame: "map", position: [0.1, 0.2, 0.3], joints: { elbow: 1.25, wrist: null } };

test.each([
  [3, "3"],
  [{ x: 1 }, "{x: 1}"],
  [POSE, '{frame: "map", position: [0.1, 0.2, 0.3], …}'],
  [
    Array.from({ length: 40 }, (_, index) => index),
    "[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, …]",
  ],
  [{ __repr__: "list of 1000", __class__: "list", __len__: 1000, __first__: [7, 8] }, "[7, 8, …]"],
  [{ ["a name that is longer than its place by far, and then some"]: 1, y: 2 }, "dict ⟨2⟩"],
])("of %j there is room for %s", (value, words) => {
  expect(previewValue(value, 45)).toBe(words);
});
