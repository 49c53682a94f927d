import { expect, test } from "vitest";
import type { StateStatistics } from "../../model/generated/protocol.ts";
import { rowsOf, scaleOf, sortedBy } from "./rows.ts";

function row(names: string, total_ms: number, outcome = "success"): StateStatistics {
  const ns = total_ms * 1e6;
  const lengths = { total_ns: ns, min_ns: ns, median_ns: ns, p95_ns: ns, max_ns: ns };
  return {
    path: names,
    names,
    count: 1,
    ...lengths,
    outcomes: [{ outcome: { id: 0, name: outcome }, count: 1 }],
  };
}

const ALL = [row("R", 100), row("R/grasp", 60, "aborted"), row("R/look", 1)];

test("by time, by name, and back", () => {
  const names = (key: "names" | "total", down: boolean, query = "") =>
    rowsOf(ALL, query, { key, down }).map((each) => each.names);
  expect(names("total", true)).toEqual(["R", "R/grasp", "R/look"]);
  expect(names("total", false)).toEqual(["R/look", "R/grasp", "R"]);
  expect(names("names", true)).toEqual(["R/look", "R/grasp", "R"]);
  expect(names("total", true, "ABORT gra")).toEqual(["R/grasp"]);
});

test("a heading turns its own order, and takes over from another", () => {
  const sort = { key: "total", down: true } as const;
  expect(sortedBy(sort, "total")).toEqual({ key: "total", down: false });
  expect(sortedBy(sort, "names")).toEqual({ key: "names", down: false });
  expect(sortedBy(sort, "outcomes")).toBe(sort);
});

test("lengths stand by their magnitude", () => {
  const scale = scaleOf(ALL);
  expect([scale(1e6), scale(10e6), scale(100e6)].map((at) => at.toFixed(2))).toEqual([
    "0.00",
    "0.50",
    "1.00",
  ]);
  expect(scaleOf([ALL[0] ?? row("R", 1)])(1)).toBe(0.5);
});
