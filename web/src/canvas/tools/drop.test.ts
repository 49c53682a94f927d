import { expect, test } from "vitest";
import { driver } from "../testing/driver.ts";

test("a state from the palette shows where it will stand", () => {
  const canvas = driver().bring({ insert: "execution" }, { x: 750, y: 400 });
  const { ghosts, drop, message } = canvas.controller.overlay.value;
  expect(ghosts).toEqual([{ x: 680, y: 330, width: 140, height: 140 }]);
  expect([drop, message?.text]).toEqual(["state:R", "Into “Root”"]);
  canvas.drop();
  expect(canvas.session.made.map(({ name }) => name)).toEqual(["Add execution state"]);
  expect(canvas.selection()).toMatch(/^state:R\/[A-Z]+$/);
  expect(canvas.isClear()).toBe(true);
});

test("near the border of its container it stands inside, with room for lines", () => {
  const canvas = driver().bring({ insert: "execution" }, { x: 4, y: 4 });
  const [ghost] = canvas.controller.overlay.value.ghosts;
  expect([ghost?.x, ghost?.y]).toEqual([28, 28]);
});

test("the innermost container under the pointer takes it", () => {
  const canvas = driver().bring({ insert: "barrier" }, { x: 500, y: 600 });
  expect(canvas.controller.overlay.value.drop).toBe("state:R/C");
});

test("on a transition it is inserted", () => {
  const canvas = driver();
  const [from, to] = [canvas.point("A.ok"), canvas.point("B.income")];
  canvas.bring({ insert: "execution" }, { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 });
  expect(canvas.controller.overlay.value.message?.text).toBe("Insert into the transition");
  canvas.drop();
  expect(canvas.text()).toContain("set_transition_target R 1");
});

test("a library is inserted by its command", () => {
  const canvas = driver().bring({ library: { path: "arm", name: "grasp" } }, { x: 750, y: 400 });
  canvas.drop();
  expect(canvas.commands).toEqual([
    'insert.library {"path":"arm","name":"grasp","container":"R","at":{"x":750,"y":400}}',
  ]);
});

test("a library on a transition is inserted into that", () => {
  const canvas = driver();
  const [from, to] = [canvas.point("A.ok"), canvas.point("B.income")];
  const library = { path: "arm", name: "grasp" };
  canvas.bring({ library }, { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 });
  expect(canvas.controller.overlay.value.message?.text).toBe("Insert into the transition");
  canvas.drop();
  expect(canvas.commands[0]).toContain('"transition":1}');
});

test("outside of all containers it is refused", () => {
  const canvas = driver().bring({ insert: "execution" }, { x: 980, y: 780 });
  expect(canvas.controller.overlay.value.message?.bad).toBe(true);
  canvas.drop();
  expect([canvas.session.made, canvas.refusals.length]).toEqual([[], 1]);
});

test("dragged away again nothing stays", () => {
  const canvas = driver().bring({ insert: "execution" }, { x: 750, y: 400 });
  canvas.controller.cancel();
  expect([canvas.text(), canvas.isClear()]).toEqual(["selected: nothing", true]);
});
