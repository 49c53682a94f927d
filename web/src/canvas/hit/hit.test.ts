import { expect, test } from "vitest";
import { type Driver, driver } from "../testing/driver.ts";

function at(canvas: Driver, x: number, y: number): string {
  const hit = canvas.controller.at({ x, y });
  if (!hit) return "nothing";
  const { element } = hit;
  return `${hit.on} ${element.path}${"id" in element ? `:${element.id}` : ""}`;
}

test("the innermost state is hit, in its ground and on its name", () => {
  const canvas = driver();
  expect(at(canvas, 120, 230)).toBe("state R/A");
  expect(at(canvas, 150, 175)).toBe("name R/A");
  expect(at(canvas, 580, 600)).toBe("state R/C");
  expect(at(canvas, 990, 790)).toBe("nothing");
});

test("ports are hit from both sides of the border, corners only of what is selected", () => {
  const canvas = driver();
  const { x, y } = canvas.point("A.ok");
  expect(at(canvas, x + 8, y)).toBe("port R/A:0");
  expect(at(canvas, x - 8, y)).toBe("port R/A:0");
  expect(at(canvas, 250, 250)).toBe("state R/A");
  expect(at(canvas.select("state:R/A"), 252, 252)).toBe("grip R/A");
});

test("what is too small to be drawn is not hit", () => {
  const canvas = driver();
  canvas.view.camera.value = { x: 0, y: 0, scale: 0.155 };
  expect(at(canvas, 18, 33)).toBe("name R/A");
  canvas.view.camera.value = { x: 0, y: 0, scale: 0.03 };
  expect(at(canvas, 4, 5)).toBe("state R");
});

test("lines are hit near by, in the mode in which they show", () => {
  const canvas = driver();
  const [from, to] = [canvas.point("A.ok"), canvas.point("B.income")];
  const [x, y] = [(from.x + to.x) / 2, (from.y + to.y) / 2];
  expect(at(canvas, x, y + 5)).toBe("line R:1");
  canvas.view.modes.value = { ...canvas.view.modes.value, transitions: false };
  expect(at(canvas, x, y + 5)).toBe("state R");
});

test("aborted and preempted are hit where they show", () => {
  const canvas = driver();
  const quiet = canvas.point("A.aborted");
  expect(at(canvas, quiet.x, quiet.y)).not.toContain("port");
  canvas.view.modes.value = { ...canvas.view.modes.value, aborted: true };
  expect(at(canvas, quiet.x, quiet.y)).toBe("port R/A:-1");
});

test("ports of a container that fills the view are hit at the view's edges", () => {
  const canvas = driver();
  canvas.view.camera.value = { x: 120, y: 380, scale: 3 };
  expect(at(canvas, 995, 5)).not.toContain("port R/C");
  const found = [...Array(80).keys()].map((row) => at(canvas, 995, row * 10));
  expect(found).toContain("port R/C:0");
});

test("two thousand states are searched from the root inwards", () => {
  const rows = Array.from({ length: 20 }, (_, column) => {
    const inner = Array.from(
      { length: 100 },
      (_, row) => `      S${row} execution ${(row % 10) * 100} ${Math.floor(row / 10) * 100} 80 80`,
    );
    const [x, y] = [(column % 10) * 1100, Math.floor(column / 10) * 1100];
    return [`    C${column} hierarchy ${x} ${y} 1000 1000`, ...inner].join("\n");
  });
  const canvas = driver(`\n  R hierarchy 0 0 11000 2200\n${rows.join("\n")}`);
  canvas.view.camera.value = { x: 0, y: 0, scale: 0.5 };
  expect(at(canvas, 20, 6)).toBe("state R/C0/S0");
});

test("a breakpoint is set on the upper border, beside the corner that resizes", () => {
  const canvas = driver();
  const [x = 0, y = 0] = canvas.box("A").split(" ").map(Number);
  expect(at(canvas, x + 16, y - 3)).toBe("breakpoint R/A");
  expect(at(canvas, x + 40, y + 3)).not.toContain("breakpoint");
  expect(at(canvas.select("state:R/A"), x + 1, y + 1)).toBe("grip R/A");
});
