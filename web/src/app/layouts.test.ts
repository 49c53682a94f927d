import { expect, test } from "vitest";
import { SHIPPED, sizeOn } from "./layouts.ts";

test("sides leave the canvas at least half of a narrow page, and are as wide as wanted on a wide one", () => {
  const debug = SHIPPED["Debug"];
  const sizes = (width: number, height: number) =>
    (["left", "right", "bottom"] as const).map((side) => {
      const wanted = debug?.[side];
      return wanted ? sizeOn({ width, height }, side, wanted) : 0;
    });
  expect(sizes(1600, 930)).toEqual([264, 380, 280]);
  expect(sizes(1024, 650)).toEqual([225, 307, 260]);
});

test("mission control is as wide as it is made to be", () => {
  const left = SHIPPED["Mission control"]?.left;
  expect(left && sizeOn({ width: 1024, height: 700 }, "left", left)).toBe(600);
});
