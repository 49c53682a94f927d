import fc from "fast-check";
import { expect, test } from "vitest";
import { distance, type Point } from "../../model/geometry.ts";
import { isExactlyRightAngled } from "../../plan/right_angles.ts";
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

test("dragging a line at right angles moves a piece of it, and shows it", () => {
  const canvas = driver(MACHINE);
  const { x, y } = middle(canvas);
  canvas.press({ x, y }).drag({ x, y: y + 80 });
  expect(canvas.controller.doing).toBe("waypoint");
  const bends = [
    [168, y],
    [168, y + 80],
    [582, y + 80],
    [582, y],
  ];
  const shown = canvas
    .shown()
    .routes("R")[1]
    ?.points.map((point) => [point.x, point.y]);
  for (const bend of bends) expect(shown).toContainEqual(bend);
  canvas.release();
  expect(canvas.text()).toContain(`set_waypoints R {"transition":1} ${JSON.stringify(bends)}`);
  expect(canvas.selection()).toBe("transition:R:1");
});

test("a piece near the straight line joins it", () => {
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

test("a line keeps its right angles wherever and however often it is dragged", () => {
  const part = fc.double({ min: 0, max: 1, noNaN: true });
  const by = fc.double({ min: -300, max: 300, noNaN: true });
  const drags = fc.array(fc.record({ part, x: by, y: by }), { minLength: 1, maxLength: 5 });
  fc.assert(
    fc.property(drags, fc.constantFrom("B", "C"), (all, target) => {
      const canvas = driver(MACHINE.replace("A.ok > B", `A.ok > ${target}`));
      canvas.select("transition:R:1");
      for (const { part, x, y } of all) {
        const points = canvas.shown().routes("R")[1]?.points ?? [];
        const at = alongLine(points, part);
        canvas
          .press(at)
          .drag({ x: at.x + x, y: at.y + y })
          .release();
        const shown = canvas.shown().routes("R")[1]?.points ?? [];
        expect(isExactlyRightAngled(shown), JSON.stringify(shown)).toBe(true);
      }
    }),
  );
});

/** A point of a line, by its part of the length, not too near to the ends: those are led elsewhere. */
function alongLine(points: readonly Point[], part: number): Point {
  const lengths = points.slice(1).map((to, index) => distance(points[index] ?? to, to));
  let left = (0.1 + 0.8 * part) * lengths.reduce((sum, length) => sum + length, 0);
  for (const [index, length] of lengths.entries()) {
    const [from, to] = [points[index], points[index + 1]];
    if (from && to && left <= length) {
      return {
        x: from.x + ((to.x - from.x) * left) / length,
        y: from.y + ((to.y - from.y) * left) / length,
      };
    }
    left -= length;
  }
  throw new Error("no line");
}

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
