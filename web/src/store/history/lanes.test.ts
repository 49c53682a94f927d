import { expect, test } from "vitest";
import { events, randomRun } from "../testing/events.ts";
import { Calls } from "./calls.ts";
import { Journal } from "./journal.ts";
import { type CallRow, type Lane, lookOf, RunLanes } from "./lanes.ts";

class RecordedRun {
  readonly journal = new Journal();
  readonly calls = new Calls(this.journal);
  readonly lanes = new RunLanes(this.calls);

  add(entries: Parameters<Journal["add"]>[0]): this {
    this.journal.add(entries, (entries.at(-1)?.sequence ?? 0) + 1);
    this.calls.follow();
    this.lanes.follow();
    return this;
  }
}

/** Each lane with its rows and leaves: the first events of calls, and the number of failures. */
function written({ calls, lanes }: RecordedRun): string {
  const first = (call: number) => calls.journal.sequence(calls.begin(call));
  const row = (each: CallRow) => `${each.calls.map(first).join(" ")} (${each.failed(0, Infinity)})`;
  const lane = (each: Lane) => [...each.rows, each.leaves].map(row).join(" | ");
  return lanes
    .all()
    .map((each) => `${"  ".repeat(each.depth)}${each.path}: ${lane(each)}`)
    .join("\n");
}

test("each branch of concurrency has a lane inside that of its concurrency state", () => {
  const run = new RecordedRun().add(
    events(`> R
      > R/A
      < R/A done
      > R/P
      > R/P/X
      > R/P/X/Y
      > R/P/Z
      < R/P/X/Y aborted
      < R/P/X aborted
      < R/P/Z preempted
      < R/P done`),
  );
  expect(written(run)).toBe(
    `R: 1 (0) | 2 4 (0) | 2 4 (0)
  R/P/X: 5 (1) | 6 (1) | 6 (1)
  R/P/Z: 7 (0) | 7 (0)`,
  );
});

test("however the events are cut, the lanes are the same", () => {
  for (let seed = 1; seed <= 20; seed++) {
    const all = randomRun(seed, 400);
    const cut = new RecordedRun();
    for (let from = 0; from < all.length; from += 1 + (seed % 9)) {
      cut.add(all.slice(from, from + 1 + (seed % 9)));
    }
    expect(written(cut)).toBe(written(new RecordedRun().add(all)));
  }
});

test("in a row one call comes after the other, and is found by its events", () => {
  for (let seed = 1; seed <= 20; seed++) {
    const { calls, lanes } = new RecordedRun().add(randomRun(seed, 400));
    for (const { rows } of lanes.all()) {
      for (const row of rows) {
        for (const [at, call] of row.calls.entries()) {
          const next = row.calls[at + 1];
          if (next !== undefined) expect(calls.end(call)).toBeLessThanOrEqual(calls.begin(next));
          expect(row.firstFrom(calls.begin(call))).toBe(at);
          expect(row.firstOpenAfter(calls.begin(call))).toBe(at);
        }
      }
    }
  }
});

test("a hundred thousand events are put into lanes at once, and looks are told apart", () => {
  const run = new RecordedRun().add(randomRun(7, 100_000));
  expect(run.journal.length).toBeGreaterThanOrEqual(100_000);
  const appearances = new Set(run.calls.inside(0).map((call) => lookOf(run.calls, call)));
  expect(appearances.size).toBeGreaterThan(0);
});
