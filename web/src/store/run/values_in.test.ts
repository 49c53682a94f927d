/** Values of a state and of its content: those of a moment, and those ahead of their events. */

import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Moment, WatchedValue } from "../../model/generated/protocol.ts";
import { aheadKey } from "../history/ahead.ts";
import type { Watch } from "../history/run.ts";
import { runLine, watched } from "../testing/watched.ts";
import { isIn, valuesIn } from "./values_in.ts";

test("a state is in itself, and one with a longer name is not", () => {
  const paths = ["R/A", "R/A/B", "R/AB", "R"];
  expect(paths.map((path) => isIn(path, "R/A"))).toEqual([true, true, false, false]);
});

test("the newest of each value counts, wherever it came from", () => {
  const { watch: plain } = watched(runLine("live"));
  const active = [
    { path: "R", inputs: { x: 1 }, scoped: { n: 2 }, ended: [{ path: "R/A", outputs: { y: 3 } }] },
    { path: "R/B", inputs: { x: 4 }, scoped: {}, ended: [] },
  ];
  const ahead: readonly Partial<WatchedValue>[] = [
    { kind: "output", path: "R/A", name: "y", sequence: 9, t_ns: 5, value: 30, large: null },
    { kind: "input", path: "R/C", name: "z", sequence: 8, t_ns: 4, value: null },
  ];
  const values = new Map((ahead as WatchedValue[]).map((value) => [aheadKey(value), value]));
  const watch = {
    ...plain,
    playheadSnapshot: signal({ picture: { sequence: 1, active } as unknown as Moment, at_ms: 0 }),
    ahead: signal({ watching: null, values }),
  } as Watch;
  const valuesOf = (state: string) =>
    valuesIn(watch, state).map(({ path, name, value, aheadAt_ns }) => [
      path,
      name,
      value,
      aheadAt_ns,
    ]);
  expect(valuesOf("R/A")).toEqual([["R/A", "y", 30, 5]]);
  expect(valuesOf("R").map(([path, name]) => `${path}.${name}`)).toEqual([
    "R.x",
    "R.n",
    "R/A.y",
    "R/B.x",
    "R/C.z",
  ]);
});
