import { expect, test } from "vitest";
import { driver } from "../testing/driver.ts";

test("the middle button drags the view", () => {
  const canvas = driver().press("A", {}, { pans: true }).by(-100, 50).release();
  expect(canvas.view.camera.value).toEqual({ x: 100, y: -50, scale: 1 });
  expect(canvas.text()).toBe("selected: nothing");
});

test("a mouse wheel zooms at the pointer", () => {
  const canvas = driver();
  const before = canvas.point("A");
  canvas.turn("A", { deltaY: -120 });
  expect(canvas.view.camera.value.scale).toBeGreaterThan(1.1);
  expect(canvas.point("A").x).toBeCloseTo(before.x);
});

test("two fingers on a touch pad pan, pinching zooms", () => {
  const canvas = driver().turn("A", { deltaX: 3, deltaY: 12 });
  expect(canvas.view.camera.value).toEqual({ x: 3, y: 12, scale: 1 });
  canvas.turn("A", { deltaY: -8, ctrl: true });
  expect(canvas.view.camera.value.scale).toBeCloseTo(Math.exp(0.08));
});

test("a wheel that is set to pan pans, and zooms with Ctrl", () => {
  const canvas = driver();
  canvas.wheel = "pan";
  canvas.turn("A", { deltaY: 120 });
  expect(canvas.view.camera.value).toEqual({ x: 0, y: 120, scale: 1 });
  canvas.turn("A", { deltaY: 120, ctrl: true });
  expect(canvas.view.camera.value.scale).toBeLessThan(1);
});

test("one finger pans, a second one zooms, and what is under them stays", () => {
  const canvas = driver().press({ x: 400, y: 300 }, {}, { touch: 1 });
  canvas.drag({ x: 420, y: 300 }, {}, 1);
  expect(canvas.view.camera.value).toEqual({ x: -20, y: 0, scale: 1 });
  canvas.press({ x: 620, y: 300 }, {}, { touch: 2 }).drag({ x: 820, y: 300 }, {}, 2);
  expect(canvas.view.camera.value).toEqual({ x: 190, y: 150, scale: 2 });
  canvas.release(2).release(1);
  expect(canvas.isClear()).toBe(true);
});

test("a finger moves a state that is selected, and selects by a tap", () => {
  const canvas = driver().press("A", {}, { touch: 1 }).release(1);
  expect(canvas.selection()).toBe("state:R/A");
  canvas.press("A", {}, { touch: 1 }).drag({ x: 183, y: 232 }, {}, 1).release(1);
  expect(canvas.box("A")).toBe("83 157 200 150");
});
