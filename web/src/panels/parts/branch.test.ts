import { expect, test } from "vitest";
import type { Phase } from "../../model/generated/protocol.ts";
import type { Active } from "../../store/run/active.ts";
import { inOrder } from "./branch.ts";

const lane = (path: string, phase: Phase): Active => ({
  path,
  name: path,
  phase,
  since_ms: 0,
  branch: "",
  detail: null,
  held: [],
});

test("what waits and what is held comes before what runs", () => {
  const lanes = [
    lane("R/D", "running"),
    lane("R/C", "held"),
    lane("R/B", "running"),
    lane("R/A", "preempted"),
    lane("R/E", "waiting"),
    lane("R/F", "interrupted"),
  ];
  expect(inOrder(lanes).map(({ path }) => path)).toEqual([
    "R/F",
    "R/E",
    "R/C",
    "R/A",
    "R/B",
    "R/D",
  ]);
});
