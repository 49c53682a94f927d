import fc from "fast-check";
import { expect, test, vi } from "vitest";
import { type Driver, driver } from "./testing/driver.ts";

const point = fc.record({
  x: fc.integer({ min: -50, max: 1050 }),
  y: fc.integer({ min: -50, max: 850 }),
});
const keys = fc.record({ shift: fc.boolean(), ctrl: fc.boolean(), alt: fc.boolean() });
const KEYS = ["Escape", "Enter", "Tab", " ", "ArrowRight", "ArrowDown", "Control"];

const act = fc.oneof(
  fc.record({ act: fc.constant("press" as const), point, keys }),
  fc.record({ act: fc.constant("drag" as const), point, keys }),
  fc.record({ act: fc.constant("release" as const) }),
  fc.record({ act: fc.constant("key" as const), key: fc.constantFrom(...KEYS), keys }),
  fc.record({
    act: fc.constant("turn" as const),
    point,
    delta: fc.integer({ min: -400, max: 400 }),
  }),
  fc.record({ act: fc.constant("connect" as const) }),
  fc.record({ act: fc.constant("bring" as const), point }),
  fc.record({ act: fc.constant("touch" as const), point, finger: fc.constantFrom(1, 2) }),
  fc.record({ act: fc.constant("lift" as const), finger: fc.constantFrom(1, 2) }),
  fc.record({ act: fc.constant("click" as const), point, keys }),
);

type Act = typeof act extends fc.Arbitrary<infer T> ? T : never;

function perform(canvas: Driver, each: Act): void {
  if (each.act === "press") canvas.press(each.point, each.keys);
  else if (each.act === "drag") canvas.drag(each.point, each.keys);
  else if (each.act === "release") canvas.release();
  else if (each.act === "key") canvas.key(each.key, each.keys);
  else if (each.act === "turn") canvas.turn(each.point, { deltaY: each.delta });
  else if (each.act === "connect") canvas.controller.connect();
  else if (each.act === "touch") canvas.press(each.point, {}, { touch: each.finger });
  else if (each.act === "lift") canvas.release(each.finger);
  else if (each.act === "bring") canvas.bring({ insert: "execution" }, each.point);
  else canvas.click(each.point, each.keys);
}

test("whatever pointer, wheel and keys do, nothing throws and no gesture leaves anything behind", async () => {
  await fc.assert(
    fc.asyncProperty(fc.array(act, { maxLength: 30 }), async (acts) => {
      const canvas = driver();
      for (const each of acts) perform(canvas, each);
      canvas.release(1).release(2).release();
      canvas.controller.cancel();
      await canvas.answered();
      expect(canvas.isClear()).toBe(true);
      const { x, y, scale } = canvas.view.camera.value;
      expect([x, y, scale].every(Number.isFinite)).toBe(true);
    }),
    { numRuns: 200 },
  );
});

test("any drag can be cancelled without an edit", () => {
  fc.assert(
    fc.property(point, point, keys, (from, to, held) => {
      const canvas = driver().press(from, held).drag(to);
      canvas.controller.cancel();
      canvas.release();
      expect([canvas.session.made, canvas.isClear()]).toEqual([[], true]);
    }),
    { numRuns: 200 },
  );
});

test("what is let go shows where the gesture showed it, before the server answers", () => {
  const canvas = driver().press("A").by(33, 57);
  const [box, routes] = [canvas.shown().box("R/A"), canvas.shown().routes("R")];
  canvas.release();
  expect(canvas.isClear()).toBe(true);
  expect([canvas.shown().box("R/A"), canvas.shown().routes("R")]).toEqual([box, routes]);
});

test("a gesture writes nothing, and shows other objects only for what its edit touches", () => {
  const canvas = driver().press("A").by(33, 57);
  const { machine } = canvas.session;
  const [version, rest] = [machine.version, canvas.controller.layout().root?.children];
  canvas.by(10, 0);
  const shown = canvas.shown().root?.children;
  expect(machine.version).toBe(version);
  expect(canvas.controller.layout().root?.children).toBe(rest);
  const other = shown?.filter((child, index) => child !== rest?.[index]);
  expect(other?.map(({ path }) => path)).toEqual(["R/A"]);
});

test("keys that change a gesture count while the pointer rests", () => {
  const canvas = driver().press("A").by(33, 57);
  canvas.controller.modifiers({ shift: false, ctrl: false, alt: true });
  expect(canvas.controller.overlay.value.ghosts).toHaveLength(1);
  canvas.controller.modifiers({ shift: false, ctrl: false, alt: false });
  expect(canvas.controller.overlay.value.provisional?.held).toEqual(new Set(["R/A"]));
});

test("the pointer knows the container that it is over", () => {
  expect(driver().hover({ x: 500, y: 600 }).controller.pointer()).toEqual({
    path: "R/C",
    at: { x: 400, y: 250 },
  });
});

test("what may not be edited says so at the pointer and when it is let go, and nothing is sent", () => {
  const fixed = "This is the machine as the run went by it.";
  const canvas = driver();
  canvas.session.fixed = fixed;
  canvas.press("A").by(30, 30);
  expect(canvas.controller.overlay.value.message?.text).toBe(fixed);
  expect(canvas.controller.overlay.value.provisional).toBeNull();
  canvas.release();
  canvas.select("state:R/A").key("ArrowRight", { ctrl: true });
  canvas.bring({ insert: "execution" }, { x: 500, y: 300 }).drop();
  canvas.controller.rename("R/A");
  expect([canvas.session.made, canvas.renamed]).toEqual([[], []]);
  expect(canvas.refusals).toEqual([fixed, fixed, fixed, fixed]);
});

test("who may not edit still selects and looks around", () => {
  const canvas = driver();
  canvas.session.fixed = "You may look at it.";
  canvas.click("B");
  expect(canvas.selection()).toBe("state:R/B");
  canvas.press({ x: 10, y: 790 }).by(40, 40);
  expect(canvas.controller.overlay.value.message).toBeNull();
  canvas.release();
  expect(canvas.refusals).toEqual([]);
});

test("a copy that is let go over a container goes into it", () => {
  const canvas = driver().press("A", { alt: true }).drag({ x: 450, y: 600 });
  expect(canvas.controller.overlay.value.message?.text).toBe("Copy into “Box”");
  expect(canvas.release().text()).toMatch(/^Duplicate Scan: paste R\/C /m);
});

test("what a move into a container costs is said at the pointer", () => {
  const canvas = driver().press("A").drag({ x: 450, y: 600 });
  expect(canvas.controller.overlay.value.message?.text).toBe(
    "Move into “Box”; removes 2 connections",
  );
});

test("nudges in a row are one step, and end before anything else is done", async () => {
  vi.useFakeTimers();
  const canvas = driver().select("state:R/A");
  const from = canvas.box("A");
  for (let count = 0; count < 10; count += 1) canvas.key("ArrowRight", { ctrl: true });
  expect(canvas.session.made).toEqual([]);
  expect(canvas.box("A")).toBe(from);
  expect(canvas.controller.overlay.value.provisional?.held).toEqual(new Set(["R/A"]));
  vi.advanceTimersByTime(1_000);
  expect(canvas.session.made.map(({ name }) => name)).toEqual(["Move Scan"]);
  await canvas.answered();
  canvas.key("ArrowDown", { alt: true });
  canvas.controller.flush();
  expect(canvas.session.made.length).toBe(2);
  canvas.key("ArrowDown", { alt: true }).press("B");
  expect(canvas.session.made.length).toBe(3);
  canvas.release();
  vi.useRealTimers();
});
