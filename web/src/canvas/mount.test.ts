// @vitest-environment happy-dom
import { signal } from "@preact/signals-core";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { dragged } from "../store/page/dragged.ts";
import type { Page } from "../store/page/page.ts";
import { FIRST_SETTINGS } from "../store/page/settings.ts";
import { newView, select } from "../store/page/view.ts";
import type { RunMark } from "../store/run/marks.ts";
import { type Mounted, mountCanvas } from "./mount.ts";
import type { RunOverlay } from "./picture.ts";
import { ARM, PlainMachineSession } from "./testing/driver.ts";

const SIZE = { width: 1000, height: 800 };

function mount(view = newView(), runOverlay: () => RunOverlay = () => ({})) {
  const place = document.createElement("div");
  document.body.append(place);
  const session = new PlainMachineSession(ARM);
  const notices: string[] = [];
  const menus: string[] = [];
  const page = {
    settings: signal(FIRST_SETTINGS),
    server: { link: signal({ state: "connecting" }) },
    tell: ({ text }: { readonly text: string }) => notices.push(text),
  } as unknown as Page;
  const mounted = mountCanvas(place, {
    tab: { session, view, run: signal(null) },
    page,
    run: () => {},
    runOverlay,
    menuAt: (at, elements) => menus.push(`${at.x} ${at.y} ${elements.map(({ path }) => path)}`),
  });
  const root = place.querySelector<HTMLElement>("[role=application]");
  if (!root) throw new Error("no canvas");
  return { place, session, view, notices, menus, mounted, root };
}

type At = { readonly x: number; readonly y: number };

function send(root: HTMLElement, name: string, { x, y }: At, more: MouseEventInit = {}): Event {
  const event = new MouseEvent(name, {
    clientX: x,
    clientY: y,
    bubbles: true,
    cancelable: true,
    ...more,
  });
  root.dispatchEvent(event);
  return event;
}

let open: Mounted[] = [];

beforeEach(() => {
  vi.spyOn(HTMLElement.prototype, "clientWidth", "get").mockReturnValue(SIZE.width);
  vi.spyOn(HTMLElement.prototype, "clientHeight", "get").mockReturnValue(SIZE.height);
  HTMLElement.prototype.setPointerCapture = () => {};
});

afterEach(() => {
  for (const mounted of open) mounted.dispose();
  open = [];
  document.body.replaceChildren();
  vi.restoreAllMocks();
  vi.useRealTimers();
});

function mounting() {
  const made = mount();
  open.push(made.mounted);
  return made;
}

test("the whole machine is in view at first, and a kept camera is used in another browser tab", () => {
  const { view } = mounting();
  expect(view.camera.value.scale).toBeCloseTo(920 / 900);
  const kept = newView();
  kept.camera.value = { x: 300, y: 200, scale: 4 };
  open.push(mount(kept).mounted);
  expect(kept.camera.value).toEqual({ x: 300, y: 200, scale: 4 });
});

test("a canvas that comes back in another size has the same in its middle, and follows on", () => {
  const { view, mounted } = mounting();
  view.camera.value = { x: 100, y: 100, scale: 2 };
  view.follows.value = true;
  mounted.dispose();
  vi.spyOn(HTMLElement.prototype, "clientWidth", "get").mockReturnValue(SIZE.width / 2);
  const again = mount(view);
  open.push(again.mounted);
  expect(view.camera.value).toEqual({ x: 225, y: 100, scale: 2 });
  expect(view.follows.value).toBe(true);
  expect(again.notices).toEqual([]);
});

test("a press that is dragged moves a state", () => {
  const { root, session, view } = mounting();
  view.camera.value = { x: 0, y: 0, scale: 1 };
  send(root, "pointerdown", { x: 120, y: 230 });
  send(root, "pointermove", { x: 153, y: 287 });
  send(root, "pointerup", { x: 153, y: 287 });
  expect(session.made.map(({ name }) => name)).toEqual(["Move Scan"]);
});

test("two taps of a finger drill into a state", () => {
  const { root, view, mounted } = mounting();
  view.camera.value = { x: 0, y: 0, scale: 1 };
  const tap = (name: string) =>
    root.dispatchEvent(
      new PointerEvent(name, { clientX: 500, clientY: 600, pointerType: "touch", pointerId: 7 }),
    );
  for (const name of ["pointerdown", "pointerup", "pointerdown"]) tap(name);
  expect(mounted.control.workingContainer.value).toBe("R");
  vi.spyOn(window, "matchMedia").mockReturnValue({ matches: true } as MediaQueryList);
  tap("pointerup");
  expect(mounted.control.workingContainer.value).toBe("R/C");
});

test("the wheel zooms and the page does not scroll", () => {
  const { root, view } = mounting();
  const before = view.camera.value.scale;
  const wheel = new WheelEvent("wheel", { deltaY: -120, cancelable: true });
  root.dispatchEvent(wheel);
  expect(wheel.defaultPrevented).toBe(true);
  expect(view.camera.value.scale).toBeGreaterThan(before);
});

test("keys that the canvas uses go no further, others do", () => {
  const { root, view, place } = mounting();
  const seen: string[] = [];
  place.addEventListener("keydown", (event) => seen.push(event.key));
  const press = (key: string) =>
    root.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
  press("ArrowRight");
  press("e");
  expect(seen).toEqual(["e"]);
  expect([...view.selection.value]).toEqual(["state:R/A"]);
});

test("the menu is about what is under the pointer, by key about the selection", () => {
  const { root, view, menus } = mounting();
  view.camera.value = { x: 0, y: 0, scale: 1 };
  const event = send(root, "contextmenu", { x: 120, y: 230 }, { button: 2 });
  expect(event.defaultPrevented).toBe(true);
  root.dispatchEvent(new KeyboardEvent("keydown", { key: "F10", shiftKey: true, bubbles: true }));
  expect(menus).toEqual(["120 230 R/A", "150 175 R/A"]);
});

test("something that is dragged in from a panel is dropped", () => {
  const { root, session, view } = mounting();
  view.camera.value = { x: 0, y: 0, scale: 1 };
  dragged.value = { insert: "hierarchy" };
  expect(send(root, "dragover", { x: 700, y: 300 }).defaultPrevented).toBe(true);
  send(root, "drop", { x: 700, y: 300 });
  dragged.value = null;
  expect(session.made).toHaveLength(1);
});

test("a name is changed in place; what is refused is said and stays open, Escape leaves it", () => {
  const { mounted, place, session } = mounting();
  mounted.control.rename("R/A");
  const field = () => place.querySelector("input");
  const type = (key: string) => field()?.dispatchEvent(new KeyboardEvent("keydown", { key }));
  const first = field();
  if (!first) throw new Error("no field");
  expect([first.value, first.getAttribute("aria-label")]).toEqual(["Scan", "Name of Scan"]);
  first.value = "";
  type("Enter");
  expect(place.querySelector("[role=alert]")?.textContent).not.toBe("");
  first.value = "Look";
  type("Enter");
  expect(field()).toBeNull();
  expect(session.machine.state("R/A")?.name).toBe("Look");
  mounted.control.rename("R/A");
  type("Escape");
  expect([field(), session.made.length]).toEqual([null, 1]);
});

test("why something is not possible is told and said to screen readers", () => {
  const { mounted, notices, view, root } = mounting();
  mounted.control.beginConnection();
  expect(notices).toHaveLength(1);
  view.camera.value = { x: 0, y: 0, scale: 1 };
  select(view, [{ kind: "outcome", path: "R/A", id: 1 }]);
  mounted.control.beginConnection();
  expect(root.querySelector("[role=status]")?.textContent).toContain("Enter connects");
  expect(mounted.control.cancel()).toBe(true);
  expect(mounted.control.cancel()).toBe(false);
});

test("what the selected state comes to in a run is said, and its breakpoint stands with it", () => {
  vi.useFakeTimers();
  const held = { phase: "held", failed: false, detail: null } as RunMark;
  const runOverlay = signal<RunOverlay>({});
  const { view, root, mounted } = mount(newView(), () => runOverlay.value);
  open.push(mounted);
  select(view, [{ kind: "state", path: "R/A" }]);
  vi.advanceTimersByTime(1_000);
  const status = () => root.querySelector("[role=status]")?.textContent;
  expect(status()).toBe("");
  runOverlay.value = { runs: new Map([["R/A", held]]), breakpoints: new Map([["R/A", "on"]]) };
  vi.advanceTimersByTime(1_000);
  expect(status()).toBe("Scan is paused");
  const active = root.querySelector(`#${root.getAttribute("aria-activedescendant")}`);
  expect(active?.textContent).toMatch(/^Scan, is paused, breakpoint, /);
  runOverlay.value = {};
  vi.advanceTimersByTime(1_000);
  expect(status()).toBe("");
});

test("nothing is left when it is gone", () => {
  const added: string[] = [];
  const count = (target: EventTarget) => {
    const [add, remove] = [target.addEventListener, target.removeEventListener];
    vi.spyOn(target, "addEventListener").mockImplementation(function (this: EventTarget, ...all) {
      added.push(all[0]);
      return add.apply(target, all as Parameters<typeof add>);
    });
    vi.spyOn(target, "removeEventListener").mockImplementation((...all) => {
      added.splice(added.indexOf(all[0]), 1);
      return remove.apply(target, all as Parameters<typeof remove>);
    });
  };
  count(window);
  count(document);
  const { mounted, place, view, root } = mount();
  mounted.dispose();
  expect(added).toEqual([]);
  expect(place.children).toHaveLength(0);
  const { camera } = view;
  const before = camera.value;
  root.dispatchEvent(new WheelEvent("wheel", { deltaY: -120 }));
  expect(camera.value).toBe(before);
});

test("a picture that cannot be drawn says so, and that it can again", () => {
  const context = new Proxy(
    {},
    { get: () => () => ({ width: 1, addColorStop: () => {} }), set: () => true },
  );
  vi.spyOn(HTMLCanvasElement.prototype, "getContext").mockReturnValue(context as never);
  vi.spyOn(console, "error").mockImplementation(() => {});
  const frames: FrameRequestCallback[] = [];
  vi.stubGlobal("requestAnimationFrame", (call: FrameRequestCallback) => frames.push(call));
  const pass = () => {
    for (const call of frames.splice(0)) call(0);
  };
  let broken = true;
  const made = mount(newView(), () => ({
    get sinceSnapshot_ms(): number {
      if (broken) throw new Error("no such lane");
      return 0;
    },
  }));
  open.push(made.mounted);
  const { picture } = made.mounted;
  expect(() => pass()).not.toThrow();
  expect(picture.fault.value).toBe("no such lane");
  broken = false;
  picture.redraw();
  pass();
  expect(picture.fault.value).toBeNull();
  vi.unstubAllGlobals();
});

test("a name that someone else changes meanwhile is said, and only Enter overwrites it", () => {
  const { mounted, place, session } = mounting();
  mounted.control.rename("R/A");
  const field = place.querySelector<HTMLInputElement>("input");
  if (!field) throw new Error("no field");
  field.value = "Mine";
  void session.edit("Rename", { edit: "set_name", path: "R/A", name: "Theirs" });
  const alert = () => place.querySelector("[role=alert]")?.textContent;
  expect(alert()).toBe(
    "Someone renamed it to “Theirs”. Press Enter to keep your name, Escape to take theirs.",
  );
  field.dispatchEvent(new FocusEvent("blur"));
  expect(session.machine.state("R/A")?.name).toBe("Theirs");
});

test("after a press in the overview keys are for the canvas", () => {
  const { place, root } = mounting();
  const map = place.querySelector(".canvas-minimap canvas");
  map?.dispatchEvent(new PointerEvent("pointerdown", { button: 0, bubbles: true }));
  expect(document.activeElement).toBe(root);
});

test("a press in the overview looks elsewhere, one of another button does not", () => {
  const { place, view } = mounting();
  const map = place.querySelector(".canvas-minimap canvas");
  const press = (button: number) => {
    const before = view.camera.value;
    map?.dispatchEvent(new PointerEvent("pointerdown", { button, bubbles: true }));
    return view.camera.value !== before;
  };
  expect([2, 1, 0].map(press)).toEqual([false, false, true]);
});

test("the overview steps aside while all of the machine is in view", () => {
  const frames: FrameRequestCallback[] = [];
  vi.stubGlobal("requestAnimationFrame", (call: FrameRequestCallback) => frames.push(call));
  const context = new Proxy({}, { get: () => () => ({ width: 1 }), set: () => true });
  vi.spyOn(HTMLCanvasElement.prototype, "getContext").mockReturnValue(context as never);
  const { place, view } = mounting();
  const pass = () => {
    for (let round = 0; round < 3; round += 1) for (const call of frames.splice(0)) call(0);
  };
  const isShown = () =>
    place.querySelector<HTMLElement>(".canvas-minimap canvas")?.style.display === "block";
  pass();
  expect(isShown()).toBe(false);
  view.camera.value = { ...view.camera.value, scale: view.camera.value.scale * 3 };
  pass();
  expect(isShown()).toBe(true);
  place.querySelector<HTMLElement>(".canvas-minimap button")?.click();
  pass();
  expect(isShown()).toBe(false);
  vi.unstubAllGlobals();
});

test("a finger that rests opens the menu, one that moves does not", () => {
  vi.useFakeTimers();
  const { root, menus } = mounting();
  root.setPointerCapture = () => {};
  const touch = (name: string, x: number) =>
    root.dispatchEvent(
      new PointerEvent(name, {
        pointerType: "touch",
        pointerId: 1,
        button: 0,
        clientX: x,
        clientY: 180,
        bubbles: true,
      }),
    );
  touch("pointerdown", 200);
  vi.advanceTimersByTime(600);
  expect(menus.length).toBe(1);
  touch("pointerup", 200);
  touch("pointerdown", 200);
  touch("pointermove", 260);
  vi.advanceTimersByTime(600);
  touch("pointerup", 260);
  expect(menus.length).toBe(1);
});
