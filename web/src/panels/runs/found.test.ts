import { expect, test } from "vitest";
import type { RunSummary } from "../../model/generated/protocol.ts";
import { foundRuns } from "./found.ts";

const RUN: RunSummary = {
  id: "drill-1",
  name: "Drill",
  machine: { project: "p", path: "shop/drill" },
  author: "anna",
  started_ms: 0,
  length_ms: 10,
  events: 4,
  bytes: 100,
  keeping: "full",
  waits: null,
  phase: "finished",
  outcome: { id: 0, name: "success" },
  states_run: 2,
};
const OTHER: RunSummary = { ...RUN, id: "mill-1", name: "Mill", author: null, phase: "crashed" };

test("a search goes by all words, whatever they are of", () => {
  const ids = (search: string) => foundRuns([RUN, OTHER], search).map(({ id }) => id);
  expect(ids("")).toEqual(["drill-1", "mill-1"]);
  expect(ids("ANNA success")).toEqual(["drill-1"]);
  expect(ids("crashed")).toEqual(["mill-1"]);
  expect(ids("shop anna crashed")).toEqual([]);
});
