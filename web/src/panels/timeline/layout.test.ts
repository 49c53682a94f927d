import { expect, test } from "vitest";
import { Calls } from "../../store/history/calls.ts";
import { Journal } from "../../store/history/journal.ts";
import { RunLanes } from "../../store/history/lanes.ts";
import { events } from "../../store/testing/events.ts";
import { lanesIn, layoutOf, ROW_PX, rowAt } from "./layout.ts";

function setUp() {
  const journal = new Journal();
  const entries = events(`> R
    > R/P
    > R/P/X
    > R/P/Y
    < R/P/X done
    < R/P/Y done
    < R/P done
    > R/Z`);
  journal.add(entries, entries.length + 1);
  const calls = new Calls(journal);
  calls.follow();
  const lanes = new RunLanes(calls);
  lanes.follow();
  return { calls, lanes: lanes.all() };
}

test("lanes stand below one another, a folded one has one row", () => {
  const { lanes } = setUp();
  const open = layoutOf(lanes, new Set());
  expect(open.lanes.map(({ lane, rows }) => [lane.path, rows.length])).toEqual([
    ["R", 2],
    ["R/P/X", 1],
    ["R/P/Y", 1],
  ]);
  const folded = layoutOf(lanes, new Set(["R"]));
  expect(open.height - folded.height).toBe(ROW_PX);
  const second = open.lanes[0]?.rows[1];
  expect(rowAt(open, (second?.y ?? 0) + 1)).toBe(second);
  expect(rowAt(open, open.height + 1)).toBeUndefined();
});

test("branches that did not run in a part of time can be left out", () => {
  const { calls, lanes } = setUp();
  const paths = (from_ns: number, to_ns: number) =>
    lanesIn(calls, lanes, { from_ns, to_ns }).map(({ path }) => path);
  expect(paths(0, 9e6)).toEqual(["R", "R/P/X", "R/P/Y"]);
  expect(paths(5.5e6, 5.6e6)).toEqual(["R", "R/P/Y"]);
  expect(paths(7.5e6, 9e6)).toEqual(["R"]);
});
