// @vitest-environment happy-dom
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { act } from "react";
import { afterEach, expect, test, vi } from "vitest";
import { ARM, PlainMachineSession } from "../canvas/testing/driver.ts";
import { click, unmount } from "../ui/testing/mounted.tsx";
import { CanvasPlace } from "./canvas_place.tsx";
import { shown } from "./testing/shown.tsx";

const LOOKS = readFileSync(join(import.meta.dirname, "canvas_area.css"), "utf8");

afterEach(() => {
  unmount();
  document.head.replaceChildren();
  vi.restoreAllMocks();
  vi.unstubAllGlobals();
});

test("a picture that cannot be drawn is grey and says why, until it can be drawn again", () => {
  const style = document.createElement("style");
  style.textContent = LOOKS;
  document.head.append(style);
  const frames: FrameRequestCallback[] = [];
  vi.stubGlobal("requestAnimationFrame", (call: FrameRequestCallback) => frames.push(call));
  const pass = () =>
    act(() => {
      for (const call of frames.splice(0)) call(0);
    });
  let isBroken = true;
  const draw = () => {
    if (isBroken) throw new Error("no memory");
    return { width: 1 };
  };
  const context = new Proxy({}, { get: () => draw, set: () => true });
  vi.spyOn(HTMLCanvasElement.prototype, "getContext").mockReturnValue(context as never);
  vi.spyOn(HTMLElement.prototype, "clientWidth", "get").mockReturnValue(400);
  vi.spyOn(console, "error").mockImplementation(() => {});
  const { place } = shown((tab) => <CanvasPlace tab={tab} />, {
    session: new PlainMachineSession(ARM),
  });
  const look = () => {
    const canvas = place.querySelector(".canvas-mount");
    const message = place.querySelector(".canvas-fault[role=alert] span")?.textContent;
    return [canvas && getComputedStyle(canvas).filter, message];
  };
  pass();
  expect(look()).toEqual([
    "grayscale(1) opacity(0.45)",
    "The canvas is out of date: it could not be redrawn (no memory).",
  ]);
  isBroken = false;
  click(place.querySelector(".canvas-fault button"));
  pass();
  expect(look()).toEqual(["", undefined]);
});
