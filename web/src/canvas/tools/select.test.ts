import { expect, test } from "vitest";
import { driver } from "../testing/driver.ts";

test("a click selects what is under it, and nothing else", () => {
  const canvas = driver();
  expect(canvas.click("A").selection()).toBe("state:R/A");
  expect(canvas.click("D").selection()).toBe("state:R/C/D");
  expect(canvas.click("A.lost").selection()).toBe("outcome:R/A:1");
  expect(canvas.click({ x: 880, y: 680 }).selection()).toBe("state:R");
  expect(canvas.click({ x: 950, y: 750 }).selection()).toBe("");
});

test("Ctrl and Shift add to the selection and take from it", () => {
  const canvas = driver().click("A").click("B", { ctrl: true });
  expect(canvas.selection()).toBe("state:R/A state:R/B");
  expect(canvas.click("A", { shift: true }).selection()).toBe("state:R/B");
});

test("a state and one inside it are never selected together", () => {
  const canvas = driver().click("D").click({ x: 500, y: 600 }, { ctrl: true });
  expect(canvas.selection()).toBe("state:R/C");
});

test("a rubber band on the ground takes what it encloses, and shows it before", () => {
  const canvas = driver().press({ x: 20, y: 60 }).drag({ x: 650, y: 300 });
  expect(canvas.controller.doing).toBe("band");
  expect([...canvas.controller.overlay.value.targets.keys()]).toContain("state:R/B");
  expect(canvas.selection()).toBe("");
  expect(canvas.release().selection()).toBe("state:R/A state:R/B transition:R:1");
  expect(canvas.isClear()).toBe(true);
});

test("with Shift a rubber band begins on a state, with Ctrl it adds", () => {
  const canvas = driver().press({ x: 110, y: 600 }, { shift: true }).drag({ x: 500, y: 400 });
  expect(canvas.release().selection()).toBe("state:R/C/D");
  canvas.press({ x: 20, y: 60 }, { ctrl: true }).drag({ x: 300, y: 300 });
  expect(canvas.release().selection()).toBe("state:R/C/D state:R/A");
});

test("Escape ends the gesture, then the selection, then goes one level out", () => {
  const canvas = driver().click("A").press({ x: 20, y: 60 }).drag({ x: 650, y: 300 });
  canvas.key("Escape");
  expect([canvas.selection(), canvas.isClear()]).toEqual(["state:R/A", true]);
  expect(canvas.key("Escape").selection()).toBe("");
  canvas.controller.fit(["R/C"]);
  expect(canvas.controller.workingContainer.value).toBe("R/C");
  canvas.key("Escape");
  expect(canvas.controller.workingContainer.value).toBe("R");
});

test("a double click drills into a state, and on its name renames it", () => {
  const canvas = driver().doubleClick({ x: 500, y: 600 });
  expect(canvas.controller.workingContainer.value).toBe("R/C");
  canvas.controller.fit([]);
  expect(canvas.doubleClick("A").renamed).toEqual(["R/A"]);
});

test("a double click on the name of a closed container drills into it", () => {
  const canvas = driver(`
    R hierarchy 0 0 900 700
      C "Box" hierarchy 100 100 60 60
        D execution 10 10 20 20
  `);
  canvas.doubleClick("C");
  expect([canvas.renamed, canvas.controller.workingContainer.value]).toEqual([[], "R/C"]);
});
