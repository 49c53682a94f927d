import { expect, test } from "vitest";
import { type Driver, driver } from "../testing/driver.ts";

const MACHINE = `
  R hierarchy 0 0 900 700
    A execution 50 100 100 100 outcome ok
    B execution 600 100 100 100 outcome ok
    C execution 600 400 100 100 outcome ok
    R > A
    A.ok > B
`;

function middle(canvas: Driver) {
  const [from, to] = [canvas.point("A.ok"), canvas.point("B.income")];
  return { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 };
}

test("dragging a line makes a waypoint, and shows it", () => {
  const canvas = driver(MACHINE);
  const { x, y } = middle(canvas);
  canvas.press({ x, y }).drag({ x, y: y + 80 });
  expect(canvas.controller.doing).toBe("waypoint");
  expect(canvas.shown().routes("R")[1]?.points).toContainEqual({ x, y: y + 80 });
  canvas.release();
  expect(canvas.text()).toContain(`set_waypoints R {"transition":1} [[${x},${y + 80}]]`);
  expect(canvas.selection()).toBe("transition:R:1");
});

test("a waypoint near the straight line goes away", () => {
  const canvas = driver(MACHINE);
  const { x, y } = middle(canvas);
  canvas
    .press({ x, y })
    .drag({ x, y: y + 80 })
    .release();
  canvas.press({ x, y: y + 80 }).drag({ x, y: y + 2 });
  canvas.release();
  expect(canvas.session.made.at(-1)?.edit).toMatchObject({ waypoints: [] });
});

test("with Shift a waypoint keeps an even direction", () => {
  const canvas = driver(MACHINE);
  const at = middle(canvas);
  const from = canvas.point("A.ok");
  canvas.press(at).drag({ x: from.x + 100, y: from.y + 90 }, { shift: true });
  const line = canvas.shown().routes("R")[1];
  const point = line?.points[line.waypoints[0] ?? -1];
  expect((point?.x ?? 0) - from.x).toBeCloseTo((point?.y ?? 0) - from.y);
});

test("Escape leaves the line as it was", () => {
  const canvas = driver(MACHINE);
  const { x, y } = middle(canvas);
  canvas
    .press({ x, y })
    .drag({ x, y: y + 80 })
    .key("Escape")
    .release();
  expect([canvas.session.made, canvas.isClear()]).toEqual([[], true]);
});

test("the end of a selected line is led to another state", () => {
  const canvas = driver(MACHINE).select("transition:R:1").press("B.income").drag("C.income");
  expect(canvas.controller.overlay.value.line?.legal).toBe(true);
  canvas.release();
  expect(canvas.text()).toBe(
    'Change end of transition: set_transition_target R 1 {"state":"C"}\nselected: transition:R:1',
  );
});

test("let go over nothing the end stays where it was", () => {
  const canvas = driver(MACHINE).select("transition:R:1").press("B.income");
  canvas.drag({ x: 400, y: 600 }).release();
  expect([canvas.session.made, canvas.refusals, canvas.isClear()]).toEqual([[], [], true]);
});

test("with Ctrl a port slides along the border, around corners", () => {
  const canvas = driver(MACHINE).press("A.ok", { ctrl: true }).drag({ x: 90, y: 300 });
  const ok = canvas
    .shown()
    .ports("R/A")
    .find(({ name }) => name === "ok");
  expect(ok?.at).toEqual({ x: 90, y: 200 });
  canvas.release();
  expect(canvas.text()).toContain('set_position R/A {"outcome":0} [40,100]');
  expect(canvas.point("A.ok")).toEqual({ x: 90, y: 200 });
});

test("with Ctrl the name of a selected state moves, its corner resizes it", () => {
  const canvas = driver().select("state:R/C").press({ x: 150, y: 365 }, { ctrl: true }).by(20, 40);
  expect(canvas.controller.doing).toBe("name");
  canvas.release();
  expect(canvas.text()).toContain("set_position R/C name");
  const before = driver().select("state:R/C");
  const name = before.controller.layout().name("R/C");
  if (!name) throw new Error("no name");
  before.press({ x: name.x + name.width, y: name.y + name.height }, { ctrl: true }).by(-100, -20);
  expect(before.release().text()).toContain("set_size R/C name");
});
