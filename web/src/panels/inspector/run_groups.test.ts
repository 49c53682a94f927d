import { expect, test } from "vitest";
import type { EventDetail } from "../../model/generated/protocol.ts";
import type { StateStatus } from "../../store/run/state_status.ts";
import { runGroups } from "./run_groups.ts";

const LIVE = {
  active: null,
  next: null,
  visits: 3,
  entered: { sequence: 30, t_ns: 30 },
  left: { sequence: 31, t_ns: 31, outcome: null },
  inputs: undefined,
  outputs: undefined,
  scoped: { n: 2 },
  until: null,
  seen: 25,
} satisfies StateStatus;

const NOTHING = { detail: null, refusal: null };

function detail(sequence: number, event: object) {
  return { detail: { sequence, event } as unknown as EventDetail, refusal: null };
}

test("values that are older than the newest event are told with the event that they are of", () => {
  const entry = detail(20, { type: "entered", path: "R/A", inputs: { n: 1 } });
  const end = detail(21, { type: "left", path: "R/A", outputs: { n: 2 } });
  const found = runGroups(LIVE, entry, end).map(({ kind, values, until }) => [kind, values, until]);
  expect(found).toEqual([
    ["input", { n: 1 }, 20],
    ["output", { n: 2 }, 21],
    ["scoped_variable", { n: 2 }, 25],
  ]);
});

test("what is on its way, was not kept, or was never there", () => {
  const entry = detail(30, { type: "entered", path: "R/A" });
  const { left, scoped, ...rest } = LIVE;
  const found = runGroups({ ...rest, left: null, scoped: undefined }, entry, NOTHING);
  expect(found.map(({ values }) => values)).toEqual([null]);
  expect(runGroups(LIVE, NOTHING, NOTHING)[0]?.values).toBeUndefined();
});

test("values that the moment has are of the moment", () => {
  const at = { ...LIVE, inputs: { n: 9 }, until: 30, seen: 30 };
  expect(runGroups(at, NOTHING, NOTHING)[0]).toMatchObject({ values: { n: 9 }, until: 30 });
});
