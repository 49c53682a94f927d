/** Watch requests, and the validity of values that arrived ahead of their events. */

import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { WatchedValue } from "../../model/generated/protocol.ts";
import { aheadKey } from "../history/ahead.ts";
import type { Watch } from "../history/run.ts";
import { runLine, watched } from "../testing/watched.ts";
import { aheadOf, wishOf } from "./ahead.ts";
import type { Target } from "./watched_values.ts";

const POSE: Target = { kind: "input", path: "R/A", name: "pose" };
const MAP: Target = { kind: "global", path: "", name: "map" };

function valueAt(sequence: number): WatchedValue {
  return { ...POSE, sequence, t_ns: sequence * 1e6, value: sequence, large: null };
}

function watchWith(value: WatchedValue) {
  const { watch, tell } = watched(runLine("live"));
  const ahead = signal({ watching: null, values: new Map([[aheadKey(value), value]]) });
  return { watch: { ...watch, ahead } as Watch, tell };
}

test("a value counts until its event is here", () => {
  const { watch, tell } = watchWith(valueAt(2));
  tell({ type: "paused", paused: true });
  expect(aheadOf(watch, POSE)?.value).toBe(2);
  expect(aheadOf(watch, MAP)).toBeNull();
  tell({ type: "paused", paused: false });
  expect(aheadOf(watch, POSE)).toBeNull();
});

test("no value is ahead of a moment of the past", () => {
  const { watch } = watchWith(valueAt(9));
  watch.playhead.value = 1;
  expect(aheadOf(watch, POSE)).toBeNull();
});

test("what is watched twice is asked for once, the first first", () => {
  const wish = wishOf([POSE, MAP, POSE]);
  expect(wish.map(({ name, priority }) => [name, priority])).toEqual([
    ["pose", 0],
    ["map", 1],
  ]);
});
