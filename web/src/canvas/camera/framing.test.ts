import fc from "fast-check";
import { expect, test } from "vitest";
import { contains } from "../../model/geometry.ts";
import { screenBox } from "./camera.ts";
import { filling, revealing } from "./framing.ts";

const SIZE = { width: 800, height: 600 };
const box = fc.record({
  x: fc.double({ min: -1e4, max: 1e4, noNaN: true }),
  y: fc.double({ min: -1e4, max: 1e4, noNaN: true }),
  width: fc.double({ min: 0.01, max: 1e4, noNaN: true }),
  height: fc.double({ min: 0.01, max: 1e4, noNaN: true }),
});
const camera = fc.record({
  x: fc.double({ min: -1e4, max: 1e4, noNaN: true }),
  y: fc.double({ min: -1e4, max: 1e4, noNaN: true }),
  scale: fc.double({ min: 0.001, max: 1000, noNaN: true }),
});
const VIEW = { x: -1e-3, y: -1e-3, width: 800.002, height: 600.002 };

test("what is revealed or fitted is in the view as a whole", () => {
  fc.assert(
    fc.property(box, camera, (wanted, from) => {
      for (const to of [revealing(wanted, from, SIZE), filling([wanted], SIZE)]) {
        if (!to) throw new Error("no camera");
        const on = screenBox(to, wanted);
        expect(contains(VIEW, on)).toBe(true);
        expect(contains(VIEW, { x: on.x + on.width, y: on.y + on.height })).toBe(true);
      }
    }),
  );
});

test("the camera stays if all can be seen and read", () => {
  const from = { x: 0, y: 0, scale: 1 };
  expect(revealing({ x: 100, y: 100, width: 200, height: 100 }, from, SIZE)).toBe(from);
  expect(filling([], SIZE)).toBeNull();
});
