import { expect, test } from "vitest";
import type { Overview, OverviewBar } from "../../model/generated/protocol.ts";
import { lanesSeen } from "./seen.ts";

const PATHS = ["R", "R/A", "R/P", "R/P/X", "R/P/Y", "R/P/X/I"];

function bar(place: number, from_ns: number, to_ns: number | null): OverviewBar {
  const end = to_ns === null ? "open" : "ended";
  return { from_ns, to_ns, many: 1, failed: 0, place, sequence: from_ns, end };
}

const OVERVIEW: Overview = {
  sequence: 9,
  t_ns: 100,
  concurrent: ["R/P"],
  paths: PATHS,
  rows: [
    { place: 0, bars: [bar(0, 1, null)] },
    { place: 1, bars: [bar(1, 2, 5), bar(2, 10, 90), bar(1, 95, null)] },
    { place: 3, bars: [bar(3, 10, 80)] },
    { place: 4, bars: [bar(4, 11, 90)] },
    { place: 5, bars: [bar(5, 20, 30)] },
  ],
};

test("what the server draws stands in the lanes and rows of its states", () => {
  const lanes = lanesSeen(OVERVIEW).map(({ path, depth, parent, rows }) => [
    path,
    depth,
    parent,
    rows.map(({ bars }) => bars.map((each) => each.path).join(" ")),
  ]);
  expect(lanes).toEqual([
    ["R", 0, null, ["R", "R/A R/P R/A"]],
    ["R/P/X", 1, "R", ["R/P/X", "R/P/X/I"]],
    ["R/P/Y", 1, "R", ["R/P/Y"]],
  ]);
});

test("of a row only what reaches into a part of time is given", () => {
  const row = lanesSeen(OVERVIEW)[0]?.rows[1];
  const from = (from_ns: number, to_ns: number) =>
    row?.between(from_ns, to_ns).map((each) => each.from_ns);
  expect(from(0, 100)).toEqual([2, 10, 95]);
  expect(from(6, 9)).toEqual([]);
  expect(from(50, 60)).toEqual([10]);
  expect(from(96, 200)).toEqual([95]);
});
