import { expect, test } from "vitest";
import { Calls, NONE } from "../../store/history/calls.ts";
import { Journal } from "../../store/history/journal.ts";
import { type CallRow, RunLanes } from "../../store/history/lanes.ts";
import { events, randomRun } from "../../store/testing/events.ts";
import { barsOf, callAt } from "./bars.ts";

function rowsOf(entries: Parameters<Journal["add"]>[0]) {
  const journal = new Journal();
  journal.add(entries, entries.length + 1);
  const calls = new Calls(journal);
  calls.follow();
  const lanes = new RunLanes(calls);
  lanes.follow();
  return { journal, calls, rows: lanes.all().flatMap((lane) => lane.rows) };
}

const TOLD = events(`> R
  > R/A
  < R/A done
  > R/B
  < R/B aborted`);

test("calls are bars from their entry to their end, those in progress reach up to now", () => {
  const { calls, rows } = rowsOf(TOLD);
  const scale = { span: { from_ns: 0, to_ns: 10e6 }, width: 100, end_ns: 8e6 };
  const [outer, inner] = rows.map((row) => barsOf(calls, row, scale));
  expect(outer).toEqual([{ x: 10, width: 70, call: 0, look: "open" }]);
  expect(inner).toEqual([
    { x: 20, width: 10, call: 1, look: "ended" },
    { x: 40, width: 10, call: 2, look: "aborted" },
  ]);
});

test("what left an error looks as what aborted, whatever its outcome", () => {
  const { calls, rows } = rowsOf(events("> R\n> R/A\n< R/A done: no way\n> R/B\n< R/B done"));
  const scale = { span: { from_ns: 0, to_ns: 10e6 }, width: 100, end_ns: 8e6 };
  const appearances = barsOf(calls, rows[1] as CallRow, scale).map(
    (bar) => "look" in bar && bar.look,
  );
  expect(appearances).toEqual(["aborted", "ended"]);
});

test("what is narrow is drawn together, and failures are not lost in it", () => {
  const { calls, rows } = rowsOf(TOLD);
  const scale = { span: { from_ns: 0, to_ns: 1e9 }, width: 100, end_ns: 8e6 };
  const [, inner] = rows.map((row) => barsOf(calls, row, scale));
  expect(inner).toEqual([{ x: 0, width: 2, many: 2, failed: 1, first: 1 }]);
});

test("each call that shows is drawn once, and a row costs no more than it is wide", () => {
  const { journal, calls, rows } = rowsOf(randomRun(3, 2_500));
  const end_ns = journal.t_ns(journal.length - 1);
  for (const [from, to] of [
    [0, 1],
    [0.2, 0.21],
    [0.5, 0.9],
  ] as const) {
    const span = { from_ns: from * end_ns, to_ns: to * end_ns };
    const inSight = ({ calls: all }: CallRow) =>
      all.filter(
        (call) =>
          calls.began_ns(call) <= span.to_ns &&
          (calls.end(call) === NONE || calls.end(call) >= journal.indexAt(span.from_ns)),
      ).length;
    for (const row of rows) {
      const bars = barsOf(calls, row, { span, width: 300, end_ns });
      const drawn = bars.reduce((sum, bar) => sum + ("many" in bar ? bar.many : 1), 0);
      expect(drawn).toBe(inSight(row));
      expect(bars.length).toBeLessThanOrEqual(302);
    }
  }
});

test("the call at a time is found", () => {
  const { calls, rows } = rowsOf(TOLD);
  const inner = rows[1];
  if (!inner) throw new Error("there is one row only");
  expect([1.5e6, 2e6, 2.9e6, 3.5e6, 4.5e6].map((t) => callAt(calls, inner, t, 8e6))).toEqual([
    NONE,
    1,
    1,
    NONE,
    2,
  ]);
});
