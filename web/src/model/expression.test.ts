import { expect, test } from "vitest";
import { readExpression } from "./expression.ts";

function at(text: string, value: unknown): unknown {
  const expression = readExpression(text);
  if ("refused" in expression) return expression.refused;
  const worked = expression.of(value);
  return "refused" in worked ? worked.refused : worked.value;
}

const POSE = { position: [1, 2.5, -3], frame: "map", tags: { __tuple__: ["a", "b"] } };
const GRID = {
  __repr__: "array(…)",
  __class__: "ndarray",
  __dtype__: "float64",
  __shape__: [4, 2],
  __items__: [0, 1, 20, 21],
  __sampled__: [2, 2],
  __steps__: [2, 1],
};

test.each([
  ["value", 3, 3],
  ["value.position[0]", POSE, 1],
  ["value['position'][-1]", POSE, -3],
  ["len(value.position)", POSE, 3],
  ["value.tags[1]", POSE, "b"],
  ["abs(value.position[2]) + 2 * 3", POSE, 9],
  ["-value ** 2", 3, -9],
  ["(value - 1) / 2", 5, 2],
  ["value // 2 % 2", 7, 1],
  ["max(value.position)", POSE, 2.5],
  ["min(value, 2)", 5, 2],
  ["mean(value)", [1, 2], 1.5],
  ["round(value, 1)", 2.71, 2.7],
  ["value > 2 and value < 4", 3, true],
  ["not value or 7", 1, 7],
  ["value == 'map'", "map", true],
  ["value[2][1]", GRID, 21],
  ["value.shape[0]", GRID, 4],
  ["len(value)", { __repr__: "list of 900", __class__: "list", __len__: 900, __first__: [1] }, 900],
])("%s of %j", (text, value, expected) => {
  expect(at(text, value)).toEqual(expected);
});

test.each([
  ["value.speed", POSE, 'there is no "speed"'],
  ["value[3]", [1, 2, 3], "[3] is out of range: the length is 3"],
  ["value[1]", GRID, "[1] was not kept: only one in 2 was"],
  ["sum(value)", GRID, "not all of its numbers were kept"],
  ["value.x", { __repr__: "<Arm>", __class__: "Arm" }, "only the text of Arm was kept"],
  ["value + 1", "text", "str is not a number"],
  ["value / 0", 1, "division by zero"],
  ["value.", 1, "a name is missing after the point (at character 7)"],
  ["value[0", [1], "] is missing (at character 8)"],
  [
    "speed",
    1,
    "speed is unknown: use value, or one of the functions len, abs, min, max, sum, mean, round (at character 1)",
  ],
  ["value; import os", 1, "; does not fit here (at character 6)"],
  ["", 1, "the expression is incomplete (at character 1)"],
])("%s of %j is refused in words", (text, value, reason) => {
  expect(at(text, value)).toBe(reason);
});
