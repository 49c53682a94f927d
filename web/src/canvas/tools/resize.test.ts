import { expect, test } from "vitest";
import { driver } from "../testing/driver.ts";

test("a corner of a selected state resizes it", () => {
  const canvas = driver().click("A").press({ x: 250, y: 250 }).by(40, 30);
  expect(canvas.shown().box("R/A")).toMatchObject({
    width: 240,
    height: 180,
  });
  expect(canvas.release().box("A")).toBe("50 100 240 180");
});

test("a side moves alone", () => {
  const canvas = driver().click("A").press({ x: 50, y: 150 }).by(-30, 40).release();
  expect(canvas.box("A")).toBe("20 100 230 150");
});

test("content stays where it is, with Ctrl it grows along", () => {
  const plain = driver().click("C").press({ x: 100, y: 350 }).by(-40, -40).release();
  expect([plain.box("C"), plain.box("D")]).toEqual(["60 310 540 340", "150 430 150 100"]);
  const scaled = driver().click("C").press({ x: 600, y: 650 }).by(-100, -60, { ctrl: true });
  expect(scaled.controller.overlay.value.provisional?.isScaled).toBe(true);
  expect(scaled.shown().box("R/C/D")).toEqual({ x: 140, y: 414, width: 120, height: 80 });
  scaled.release();
  expect([scaled.box("C"), scaled.box("D")]).toEqual(["100 350 400 240", "140 414 120 80"]);
});

test("with Shift the form stays", () => {
  const canvas = driver().click("A").press({ x: 250, y: 250 }).by(100, 10, { shift: true });
  expect(canvas.release().box("A")).toBe("50 100 300 225");
});

test("a state does not grow out of its container, nor into nothing", () => {
  const grown = driver().click("C").press({ x: 600, y: 650 }).by(900, 900).release();
  expect(grown.box("C")).toBe("100 350 800 350");
  const shrunk = driver().click("A").press({ x: 250, y: 250 }).by(-900, -900).release();
  expect(shrunk.box("A")).toBe("50 100 14 14");
});

test("the root grows to the right and downwards only", () => {
  const canvas = driver().click({ x: 880, y: 690 }).press({ x: 900, y: 700 }).by(40, 50).release();
  expect(canvas.box("R")).toBe("0 0 940 750");
  expect(canvas.press({ x: 0, y: 300 }).by(-20, 0).controller.doing).not.toBe("resize");
});

test("Escape leaves the size as it was", () => {
  const canvas = driver().click("A").press({ x: 250, y: 250 }).by(40, 30).key("Escape").release();
  expect([canvas.box("A"), canvas.isClear()]).toEqual(["50 100 200 150", true]);
});
