/** Keys on the timeline: arrows move by one event, with Ctrl by one entry of the selected state. Home and End move to the ends. */

import { latinKey } from "../../commands/keys.ts";
import { stepPlayhead, toEnd, toEntry } from "../../store/history/moments.ts";
import type { TimelineModel } from "./model.ts";

interface TimelineKey {
  readonly key: string;
  readonly code: string;
  readonly ctrlKey: boolean;
  readonly altKey: boolean;
}

/** Runs the action of the key; false if the key has none. */
export function timelineKey(
  key: TimelineKey,
  model: TimelineModel,
  state: string | undefined,
): boolean {
  if (key.altKey) return false;
  const isDone = key.ctrlKey ? withCtrl(key.key, model, state) : alone(latinKey(key), model, state);
  if (isDone) model.reveal();
  return isDone;
}

function withCtrl(key: string, { watch }: TimelineModel, state: string | undefined): boolean {
  if (key !== "ArrowLeft" && key !== "ArrowRight") return false;
  if (state !== undefined) toEntry(watch, state, key === "ArrowLeft" ? "before" : "after");
  return true;
}

const STEPS: Readonly<Record<string, number>> = {
  ArrowLeft: -1,
  ArrowDown: -1,
  ArrowRight: 1,
  ArrowUp: 1,
  PageUp: 10,
  PageDown: -10,
};

function alone(key: string, model: TimelineModel, state: string | undefined): boolean {
  const step = STEPS[key];
  if (step !== undefined) {
    stepPlayhead(model.watch, step);
    return true;
  }
  switch (key) {
    case "Home":
      toEnd(model.watch, "first");
      return true;
    case "End":
      toEnd(model.watch, "last");
      return true;
    case "+":
      model.zoom(0.5);
      return true;
    case "-":
      model.zoom(2);
      return true;
    case "f":
      model.fit();
      return true;
    case "z":
      return state !== undefined && model.fitState(state);
    default:
      return false;
  }
}
