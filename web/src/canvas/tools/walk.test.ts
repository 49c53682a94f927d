import { expect, test } from "vitest";
import { type Driver, driver } from "../testing/driver.ts";

function walk(canvas: Driver, ...keys: readonly string[]): string {
  for (const key of keys) canvas.key(key);
  return canvas.selection();
}

test("right and left go along transitions, otherwise to the nearest state", () => {
  const canvas = driver().select("state:R/A");
  expect(walk(canvas, "ArrowRight")).toBe("state:R/B");
  expect(walk(canvas, "ArrowLeft")).toBe("state:R/A");
  expect(walk(canvas.select("state:R/C"), "ArrowLeft")).toBe("state:R/A");
  expect(walk(canvas.select("state:R/B"), "ArrowRight")).toBe("outcome:R:0");
});

test("down goes in where a state starts, up goes out", () => {
  const canvas = driver().select("state:R");
  expect(walk(canvas, "ArrowDown")).toBe("state:R/A");
  expect(walk(canvas, "ArrowUp")).toBe("state:R");
  expect(walk(canvas.select("state:R/C"), "ArrowDown")).toBe("state:R/C/D");
});

test("with nothing selected the first key selects where one is", () => {
  expect(walk(driver(), "ArrowRight")).toBe("state:R/A");
});

test("Tab walks the ports and leaves behind the last, and from a port right follows its line", () => {
  const canvas = driver().select("state:R/A");
  expect(walk(canvas, "Tab")).toBe("income:R/A");
  const ports = canvas.controller.layout().ports("R/A").length;
  for (let port = 1; port < ports; port++) canvas.key("Tab");
  const leaves = !canvas.controller.key({ key: "Tab", shift: false, ctrl: false, alt: false });
  expect(leaves).toBe(true);
  expect(walk(canvas.select("outcome:R/A:0"), "ArrowRight")).toBe("state:R/B");
});

test("from a connection the keys lead to its ends", () => {
  const canvas = driver();
  expect(walk(canvas.select("transition:R:1"), "ArrowRight")).toBe("state:R/B");
  expect(walk(canvas.select("transition:R:1"), "ArrowLeft")).toBe("outcome:R/A:0");
});

test("Enter drills into the selected state", () => {
  const canvas = driver().select("state:R/C").key("Enter");
  expect([canvas.controller.workingContainer.value, canvas.selection()]).toEqual([
    "R/C",
    "state:R/C/D",
  ]);
});

test("Enter shows what is inside a library", () => {
  const canvas = driver(
    "R hierarchy 0 0 900 700\n  L library 300 100 300 300 library=arm/grasp",
    "G hierarchy 0 0 10 10",
  );
  canvas.select("state:R/L").key("Enter");
  expect([
    canvas.controller.workingContainer.value,
    canvas.controller.layout().children("R/L"),
  ]).toEqual(["R/L/G", ["R/L/G"]]);
});

test("Escape leaves a library and its content at once", () => {
  const canvas = driver(
    "R hierarchy 0 0 900 700\n  L library 300 100 300 300 library=arm/grasp",
    "G hierarchy 0 0 10 10",
  );
  canvas.select("state:R/L").key("Enter").key("Escape").key("Escape");
  expect(canvas.controller.workingContainer.value).toBe("R");
});

test("Escape leaves a state without content that fills the view", () => {
  const canvas = driver().select("state:R/A").key("Enter").key("Escape");
  const near = canvas.view.camera.value.scale;
  expect(canvas.key("Escape").view.camera.value.scale).toBeLessThan(near);
});

test("what is selected by keyboard comes into sight", () => {
  const canvas = driver().select("state:R/A");
  canvas.view.camera.value = { x: 0, y: 0, scale: 3 };
  canvas.key("ArrowRight");
  const { x } = canvas.point("B");
  expect(x).toBeGreaterThan(0);
  expect(x).toBeLessThan(1000);
});
