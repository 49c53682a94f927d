import { expect, test } from "vitest";
import { type Driver, driver } from "../testing/driver.ts";

const MACHINE = `
  R hierarchy 0 0 900 700
    A execution 50 100 100 100 outcome ok
    L "Grasp" library 300 100 500 500 outcome ok library=arm/grasp
`;
const CONTENT = `
  G hierarchy 0 0 1000 1000 outcome ok
    M "Approach" execution 100 100 300 300 outcome ok
    N "Close" execution 600 600 300 300 outcome ok
    G > M
    M.ok > N
`;

function opened(): Driver {
  const canvas = driver(MACHINE, CONTENT);
  canvas.view.contents.value = new Map([["R/L", true]]);
  return canvas;
}

test("what is inside a library is selected, and not edited", () => {
  const canvas = opened();
  expect(canvas.click("R/L/G/M").selection()).toBe("state:R/L/G/M");
  const { x, y } = canvas.point("R/L/G/M");
  expect(canvas.controller.at({ x: x + 68, y: y + 68 })?.on).not.toBe("grip");
});

test("dragging inside a library moves the library state", () => {
  const canvas = opened().press("R/L/G/M").by(33, 17).release();
  expect([canvas.box("L"), canvas.selection()]).toEqual(["333 117 500 500", "state:R/L"]);
  const port = opened().press("R/L/G/M.ok").by(-33, 17);
  expect(port.controller.doing).toBe("move");
});

test("a library takes no states, the container around it does", () => {
  const canvas = opened().bring({ insert: "execution" }, { x: 500, y: 560 });
  expect(canvas.controller.overlay.value.drop).toBe("state:R");
});

test("a connection that is let go inside of a library leads to the library state", () => {
  const canvas = opened().press("A.ok").drag("R/L/G/N").release();
  expect(canvas.text()).toContain('{"state":"A","outcome":0} {"state":"L"}');
});

test("a line inside a library is selected, and makes no waypoints", () => {
  const canvas = opened();
  const [from, to] = [canvas.point("R/L/G/M.ok"), canvas.point("R/L/G/N.income")];
  const at =
    canvas.controller
      .layout()
      .routes("R/L/G")
      .find(({ id }) => id === 1)?.points ?? [];
  expect(at[0]).toEqual(from);
  expect(at.at(-1)).toEqual(to);
  canvas.select("transition:R/L/G:1");
  expect(canvas.controller.at(from)?.on).not.toBe("end");
});

test("a name inside a library is refused before it is typed", () => {
  const canvas = opened().doubleClick("R/L/G/M");
  expect([canvas.renamed, canvas.refusals.length]).toEqual([[], 1]);
});
