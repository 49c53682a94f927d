import { expect, test } from "vitest";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { MODES } from "../../store/page/view.ts";
import { layoutTreeOf } from "../layout/layout_tree.ts";
import { findAgain, lookAtAll } from "./follow.ts";

const MACHINE = machineOf(
  sketch(`
R hierarchy 0 0 4000 3000 outcome done
  A execution 100 100 100 80 outcome ok
  B hierarchy 2000 1500 800 600 outcome ok
    C execution 100 100 200 150 outcome ok
    D execution 500 100 200 150 outcome ok
`),
);
const PLACES = layoutTreeOf(MACHINE, { modes: MODES, contents: new Map() });
const SIZE = { width: 1000, height: 800 };

/** The part of the root that is shown, rounded. */
function shown(...paths: readonly string[]): string {
  const camera = lookAtAll(PLACES, paths, SIZE);
  if (!camera) return "nothing";
  const [width, height] = [SIZE.width / camera.scale, SIZE.height / camera.scale];
  return [camera.x, camera.y, width, height].map((part) => Math.round(part / 100) * 100).join(" ");
}

test("what runs is shown with its container, if it can be read there", () => {
  expect(shown("R/B/C")).toBe("2000 1500 900 700");
  expect(shown("R/B/C", "R/B/D")).toBe(shown("R/B/C"));
});

test("where the container is too large one looks closer", () => {
  const [x = 0, , width = 0] = shown("R/A").split(" ").map(Number);
  expect(x).toBeLessThan(200);
  expect(width).toBeLessThan(500);
});

test("branches far apart are shown together, what is inside of what does not show as that", () => {
  const [x = 0, , width = 0] = shown("R/A", "R/B/C").split(" ").map(Number);
  expect(x).toBeLessThanOrEqual(100);
  expect(x + width).toBeGreaterThan(2300);
  expect(shown("R/B/C/deeper")).toBe(shown("R/B/C"));
});

test("the camera stays until something is out of sight, or could be much larger", () => {
  const near = { x: 2000, y: 1500, scale: 1 };
  expect(findAgain(PLACES, ["R/B/C"], near, SIZE)).toBe(null);
  expect(findAgain(PLACES, ["R/A"], near, SIZE)).not.toBe(null);
  expect(findAgain(PLACES, ["R/A"], { x: 0, y: 0, scale: 0.1 }, SIZE)).not.toBe(null);
  expect(findAgain(PLACES, ["Gone"], near, SIZE)).toBe(null);
});

test("what cannot be shown any larger is not looked at again and again", () => {
  const both = ["R/A", "R/B/C"];
  const camera = lookAtAll(PLACES, both, SIZE);
  expect(camera && findAgain(PLACES, both, camera, SIZE)).toBe(null);
});

test("what is cut off at an edge is out of sight", () => {
  const cut = { x: 2150, y: 1500, scale: 1 };
  expect(findAgain(PLACES, ["R/B/C"], cut, SIZE)).not.toBe(null);
});
