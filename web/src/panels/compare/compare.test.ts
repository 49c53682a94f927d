import { expect, test } from "vitest";
import { Journal } from "../../store/history/journal.ts";
import { events } from "../../store/testing/events.ts";
import { entriesAround } from "./around.ts";
import { stepInWords } from "./branches.tsx";
import { sorted, timingRows } from "./timing.ts";

test("what happened around a moment is told of its branch only", () => {
  const journal = new Journal();
  const entries = events(`> R
    > R/A
    > R/B
    = R/A hello
    < R/B done
    > R/B
    < R/A done
    < R/B done`);
  journal.add(entries, entries.length + 1);
  expect(entriesAround(journal, "R/B", 5).map((index) => journal.sequence(index))).toEqual([
    3, 5, 6, 8,
  ]);
  expect(entriesAround(journal, "R/B", null).map((index) => journal.sequence(index))).toEqual([
    3, 5, 6, 8,
  ]);
});

test("the first step that is other is told in words", () => {
  const step = { sequence: 3, t_ns: 0, path: "R/A", names: "Root/Look", backwards: false };
  const outcome = { id: 0, name: "seen" };
  expect([
    stepInWords(null),
    stepInWords({ ...step, outcome: null }),
    stepInWords({ ...step, outcome: null, backwards: true }),
    stepInWords({ ...step, outcome }),
    stepInWords({ ...step, outcome, backwards: true }),
  ]).toEqual([
    "no further events",
    "Look entered",
    "Look entered backwards",
    "Look ended with seen",
    "Look undone",
  ]);
});

const TIMING = [
  ["A", 2, 10e6, 2, 30e6],
  ["B", 1, 40e6, 3, 120e6],
  ["C", 1, 90e6, 0, 0],
] as const;

test("states are sorted by what differs most", () => {
  const rows = timingRows(
    TIMING.map(([names, count, total_ns, count_2, total_2]) => ({
      path: names,
      names,
      one: { count, total_ns },
      other: { count: count_2, total_ns: total_2 },
    })),
  );
  const order = (...by: [Parameters<typeof sorted>[1], boolean]) =>
    sorted(rows, ...by).map(({ names }) => names);
  expect(rows.map(({ more_ms }) => more_ms)).toEqual([-10, 0, null]);
  expect(order("one", true)).toEqual(["C", "B", "A"]);
  expect(order("more", true)).toEqual(["A", "C", "B"]);
  expect(order("counts", true)).toEqual(["B", "C", "A"]);
  expect(order("names", false)).toEqual(["A", "B", "C"]);
});
