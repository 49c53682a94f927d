import { expect, test } from "vitest";
import type { Camera } from "../../store/page/view.ts";
import { resized } from "./first_look.ts";
import { filling } from "./framing.ts";

const MACHINE = { x: 0, y: 0, width: 1000, height: 500 };
const WIDE = { width: 1100, height: 700 };
const NARROW = { width: 600, height: 700 };

function whole(size: typeof WIDE): Camera {
  const camera = filling([MACHINE], size);
  if (!camera) throw new Error("no camera");
  return camera;
}

test("a view that showed the whole machine shows the whole machine in any size", () => {
  const narrow = resized(whole(WIDE), MACHINE, WIDE, NARROW);
  expect(narrow).toEqual(whole(NARROW));
  expect(resized(narrow, MACHINE, NARROW, WIDE)).toEqual(whole(WIDE));
  const near = { x: -20, y: -20, scale: 0.9 };
  expect(resized(near, MACHINE, WIDE, NARROW)).toEqual(whole(NARROW));
});

test("else what was in the middle stays there", () => {
  const camera = { x: 400, y: 100, scale: 2 };
  expect(resized(camera, MACHINE, WIDE, NARROW)).toEqual({ x: 525, y: 100, scale: 2 });
  expect(resized(camera, null, WIDE, WIDE)).toBe(camera);
});
