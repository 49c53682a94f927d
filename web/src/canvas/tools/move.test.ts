import { expect, test } from "vitest";
import { driver } from "../testing/driver.ts";

test("a state is dragged, and shows where it will be", () => {
  const canvas = driver().press("A").by(33, 37);
  expect(canvas.shown().box("R/A")).toMatchObject({ x: 83, y: 137 });
  expect(canvas.session.made).toEqual([]);
  canvas.release();
  expect(canvas.text()).toBe("Move Scan: set_position R/A state [83,137]\nselected: state:R/A");
  expect(canvas.isClear()).toBe(true);
});

test("a small movement is a click", () => {
  expect(driver().press("A").by(2, 1).release().text()).toBe("selected: state:R/A");
});

test("selected states of one container move together", () => {
  const canvas = driver().click("A").click("B", { ctrl: true }).press("A").by(33, 57).release();
  expect([canvas.box("A"), canvas.box("B")]).toEqual(["83 157 200 150", "433 157 200 150"]);
});

test("a state snaps to others, and a line says to what", () => {
  const canvas = driver().press("A").by(33, 3);
  expect(canvas.controller.overlay.value.guides).toEqual([
    { from: { x: 83, y: 100 }, to: { x: 600, y: 100 } },
  ]);
  expect(canvas.drag({ x: 183, y: 178 }, { ctrl: true }).controller.overlay.value.guides).toEqual(
    [],
  );
});

test("a state stays inside its container, with room for lines at the border", () => {
  const canvas = driver().press("D").drag({ x: 110, y: 360 }).release();
  expect(canvas.box("D")).toBe("112 362 150 100");
  canvas.press("D").drag({ x: 590, y: 640 });
  expect(canvas.shown().box("R/C/D")).toMatchObject({ x: 438, y: 538 });
});

test("with Alt a copy is made", () => {
  const canvas = driver().press("A").by(33, 57, { alt: true });
  expect(canvas.controller.overlay.value.ghosts).toEqual([
    { x: 83, y: 157, width: 200, height: 150 },
  ]);
  canvas.release();
  expect(canvas.session.made.map(({ name }) => name)).toEqual(["Duplicate Scan"]);
  expect(canvas.box("A")).toBe("50 100 200 150");
});

test("a state goes into another container, and out of it", async () => {
  const canvas = driver().press("A").drag({ x: 450, y: 500 });
  const { drop, message } = canvas.controller.overlay.value;
  expect([drop, message?.text]).toEqual(["state:R/C", "Move into “Box”; removes 2 connections"]);
  await canvas.release().answered();
  expect(canvas.text()).toContain('move_states R ["A"] R/C ["A"]');
  expect(canvas.isClear()).toBe(true);
  const back = driver().press("D").drag({ x: 750, y: 500 }).release();
  expect(back.text()).toContain('move_states R/C ["D"] R ["D"]');
});

test("a state that is dropped on a transition is inserted there", () => {
  const canvas = driver(`
    R hierarchy 0 0 900 700
      A execution 50 100 100 100 outcome ok
      B execution 600 100 100 100 outcome ok
      N "New" execution 300 400 100 100 outcome ok
      R > A
      A.ok > B
  `);
  const [from, to] = [canvas.point("A.ok"), canvas.point("B.income")];
  canvas.press("N").drag({ x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 });
  expect(canvas.controller.overlay.value.drop).toBe("transition:R:1");
  canvas.release();
  const [made] = canvas.session.made;
  expect(JSON.stringify(made?.edit)).toContain('"set_transition_target"');
  expect(canvas.box("N").split(" ").slice(2)).toEqual(["100", "100"]);
  expect(canvas.box("N")).not.toBe("300 400 100 100");
});

test("the root does not move: its ground takes a rubber band", () => {
  const canvas = driver().press({ x: 880, y: 680 }).by(-50, -50);
  expect(canvas.controller.doing).toBe("band");
});

test("Escape takes the state back", () => {
  const canvas = driver().press("A").by(100, 100).key("Escape").release();
  expect([canvas.text(), canvas.isClear()]).toEqual(["selected: state:R/A", true]);
});

test("Ctrl and arrows move by a step, with Alt by a small one", () => {
  const canvas = driver().click("A").key("ArrowRight", { ctrl: true });
  canvas.controller.flush();
  expect(canvas.box("A")).toBe("64 100 200 150");
  canvas.key("ArrowUp", { alt: true }).controller.flush();
  expect(canvas.box("A")).toBe("64 98.6 200 150");
});

test("where the grid shows, states stand on it", () => {
  const canvas = driver();
  canvas.view.modes.value = { ...canvas.view.modes.value, grid: true };
  expect(canvas.press("A").by(33, 57).release().box("A")).toBe("100 150 200 150");
  canvas.press("A").by(33, 57, { ctrl: true }).release();
  expect(canvas.box("A")).toBe("133 207 200 150");
});
