import { expect, test } from "vitest";
import {
  median,
  presentedIntervals,
  quantile,
  scriptingPerFrame,
  type TraceEvent,
} from "./trace.ts";

function event(name: string, ms: number, length_ms: number, tid = 1): TraceEvent {
  return { name, ph: "X", ts: ms * 1_000, dur: length_ms * 1_000, pid: 7, tid };
}

test("a frame is charged with its callback, with what ran since the one before, and with nothing twice", () => {
  const events = [
    event("EventDispatch", 1, 2),
    event("FunctionCall", 1.5, 1),
    event("FireAnimationFrame", 5, 3),
    event("FunctionCall", 5.1, 2),
    event("Layout", 8, 4),
    event("RunMicrotasks", 13, 1),
    event("FireAnimationFrame", 20, 1),
    event("FireAnimationFrame", 21.5, 1),
    event("EventDispatch", 30, 9),
    event("FireAnimationFrame", 2, 9, 2),
  ];
  expect(scriptingPerFrame(events)).toEqual([5, 3]);
});

test("what is shown is measured from one frame to the next", () => {
  const shown = [0, 16, 33, 66].map((ms) => event("DrawFrame", ms, 0, 3));
  const intervals = presentedIntervals([...shown, event("DrawFrame", 40, 0, 4)]);
  expect(intervals).toEqual([16, 17, 33]);
  expect([median(intervals), quantile(intervals, 0.95)]).toEqual([17, 33]);
});
