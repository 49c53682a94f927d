import { expect, test } from "vitest";
import { driver } from "../testing/driver.ts";
import { nearerTo, type VisiblePort } from "./targets.ts";

test("a transition is drawn from port to port, and says where it may end", () => {
  const canvas = driver().press("A.lost").by(50, 50);
  const { targets, line } = canvas.controller.overlay.value;
  expect(targets.get("income:R/C")).toBe(true);
  expect(targets.has("input:R/B:0")).toBe(false);
  expect(line).toMatchObject({ data: false, legal: null });
  canvas.drag("C.income");
  expect(canvas.controller.overlay.value.line?.legal).toBe(true);
  expect(canvas.release().text()).toBe(
    'Add transition: add_transition R 3 {"state":"A","outcome":1} {"state":"C"}\nselected: nothing',
  );
});

test("a finger draws from an outcome that it misses a little, of a state that is not selected", () => {
  const canvas = driver();
  const { x, y } = canvas.point("A.lost");
  const [from, to] = [{ x: x + 14, y: y + 8 }, canvas.point("C.income")];
  canvas.press(from, {}, { touch: 1 }).drag(to, {}, 1).release(1);
  expect(canvas.text()).toContain('add_transition R 3 {"state":"A","outcome":1} {"state":"C"}');
});

test("the line snaps to a port that is near", () => {
  const canvas = driver();
  const near = canvas.point("C.income");
  canvas.press("A.lost").drag({ x: near.x - 12, y: near.y + 8 });
  expect(canvas.controller.overlay.value.line?.to).toEqual(near);
});

test("a data flow is drawn the other way round too", () => {
  const canvas = driver().press("B.pose").drag("A.pose");
  expect(canvas.controller.overlay.value.message?.text).toBe("To output pose of Scan, type int");
  canvas.release();
  expect(canvas.text()).toContain(
    'add_data_flow R 0 {"state":"A","port":0} {"state":"B","port":0}',
  );
});

test("dropped on a state it makes the ports that it needs, over levels", () => {
  const canvas = driver().press("A.pose").drag("D");
  expect(canvas.controller.overlay.value.message?.text).toContain(
    "Adds the input “pose” to “Inner”",
  );
  canvas.release();
  expect(canvas.text()).toContain(
    "add_port R/C/D input 0 pose int null; add_port R/C input 0 pose",
  );
});

test("dropped on the border of the container an outcome becomes one of the container", () => {
  const canvas = driver().press("D.ok").drag({ x: 598, y: 600 });
  expect(canvas.controller.overlay.value.message?.text).toBe("Adds the outcome “ok_0” to “Box”");
});

test.each(["C.income", "C"])("a second line from an outcome leads its transition to %s", (goal) => {
  const canvas = driver().press("A.ok").drag(goal);
  const { message, line } = canvas.controller.overlay.value;
  expect([line?.legal, message?.text]).toEqual([true, "Leads the transition of “ok” here"]);
  expect(canvas.release().text()).toContain('set_transition_target R 1 {"state":"C"}');
  expect(canvas.refusals).toEqual([]);
});

test("a line dropped on empty ground says where to drop it", () => {
  const canvas = driver().press("A.lost").drag({ x: 700, y: 300 }).release();
  expect(canvas.refusals).toEqual([
    "Nothing is connected: drop the line on a state or an outcome.",
  ]);
});

test("what is not legal is said at the pointer, and refused when it is let go", () => {
  const canvas = driver().press("A.ok").drag("B.pose");
  const { message, line } = canvas.controller.overlay.value;
  expect([line?.legal, message?.bad]).toEqual([false, true]);
  canvas.release();
  expect(canvas.session.made).toEqual([]);
  expect(canvas.refusals).toEqual([message?.text]);
  expect(canvas.isClear()).toBe(true);
});

test("Escape ends the line", () => {
  const escaped = driver().press("A.lost").drag("C.income").key("Escape").release();
  expect([escaped.text(), escaped.isClear()]).toEqual(["selected: nothing", true]);
});

test("the view zooms while a line is drawn", () => {
  const canvas = driver().press("A.lost").drag("C.income");
  canvas.turn({ x: 500, y: 400 }, { deltaY: 240 });
  expect(canvas.view.camera.value.scale).toBeLessThan(1);
  expect(canvas.controller.doing).toBe("connect");
  expect(canvas.drag("C.income").release().text()).toContain("add_transition R 3");
});

test("space sets waypoints on the way", () => {
  const canvas = driver().press("A.lost").drag({ x: 300, y: 300 }).key(" ");
  expect(canvas.controller.overlay.value.line?.through).toEqual([{ x: 300, y: 300 }]);
  canvas.drag("C.income").release();
  expect(canvas.text()).toContain('set_waypoints R {"transition":3} [[300,300]]');
});

test("drawn backwards the waypoints are turned round", () => {
  const canvas = driver()
    .press("C.income")
    .drag({ x: 40, y: 330 })
    .key(" ")
    .drag({ x: 280, y: 300 });
  canvas.key(" ").drag("A.lost").release();
  expect(canvas.text()).toContain('set_waypoints R {"transition":3} [[280,300],[40,330]]');
});

test("by keyboard targets are chosen one after the other", () => {
  const canvas = driver().select("state:R/A");
  canvas.controller.connect();
  expect(canvas.controller.overlay.value.message?.text).toContain("Enter connects");
  const first = canvas.controller.overlay.value.line?.to;
  canvas.key("ArrowRight");
  expect(canvas.controller.overlay.value.line?.to).not.toEqual(first);
  canvas.key("Tab", { shift: true });
  expect(canvas.controller.overlay.value.line?.to).toEqual(first);
  canvas.key("Enter");
  expect(canvas.text()).toContain('add_transition R 3 {"state":"A","outcome":1}');
  expect(canvas.isClear()).toBe(true);
});

test("begun by keyboard it continues by pointer: clicks set waypoints, and the last one connects", () => {
  const canvas = driver().select("outcome:R/A:1");
  canvas.controller.connect();
  canvas.hover({ x: 300, y: 300 }).click({ x: 300, y: 300 }).hover("C.income").click("C.income");
  expect(canvas.text()).toContain('set_waypoints R {"transition":3} [[300,300]]');
});

test("without a state or port there is nothing to begin at", () => {
  const canvas = driver();
  canvas.controller.connect();
  expect(canvas.refusals).toHaveLength(1);
});

test("of two targets none comes both before and after the other", () => {
  const port = (path: string, x: number) =>
    ({ element: { kind: "income", path }, at: { x, y: 0 } }) as unknown as VisiblePort;
  const ports = [port("R/A", 1), port("R/B", 5), port("R/B", 5), port("R/A", 9)];
  const order = nearerTo({ x: 0, y: 0 }, "R/A");
  for (const one of ports) {
    for (const other of ports) {
      expect(Math.sign(order(one, other)) + Math.sign(order(other, one))).toBe(0);
    }
  }
});
