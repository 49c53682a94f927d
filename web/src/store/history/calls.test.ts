import { expect, test } from "vitest";
import { events, randomRun } from "../testing/events.ts";
import { Calls, NONE } from "./calls.ts";
import { Journal } from "./journal.ts";
import { lookOf } from "./lanes.ts";

function callsFrom(entries: Parameters<Journal["add"]>[0]): Calls {
  const journal = new Journal();
  journal.add(entries, entries.length + 1);
  const calls = new Calls(journal);
  calls.follow();
  return calls;
}

/** One line per call: depth, state, first and last event, appearance. */
function written(calls: Calls): string {
  const lines: string[] = [];
  const write = (call: number) => {
    const end = calls.end(call);
    const until = end === NONE ? "" : String(calls.journal.sequence(end));
    const from = calls.journal.sequence(calls.begin(call));
    lines.push(
      `${"  ".repeat(calls.depth(call))}${calls.path(call)} ${from}-${until} ${lookOf(calls, call)}`,
    );
    for (const inner of calls.inside(call)) write(inner);
  };
  for (const root of calls.inside(NONE)) write(root);
  return lines.join("\n");
}

test("entries and ends are calls inside one another", () => {
  const calls = callsFrom(
    events(`> R
      > R/A
      < R/A done
      > R/B
      > R/B/C
      < R/B/C aborted
      < R/B aborted
      > R/A`),
  );
  expect(written(calls)).toBe(
    `R 1- open
  R/A 2-3 ended
  R/B 4-7 aborted
    R/B/C 5-6 aborted
  R/A 8- open`,
  );
  expect(calls.of("R/A")).toEqual([1, 4]);
  expect(calls.path(calls.openAt(2))).toBe("R");
  expect(calls.path(calls.openAt(4))).toBe("R/B/C");
});

test("what goes back or dies is dropped with all inside it, and begins anew", () => {
  const calls = callsFrom(
    events(`> R
      > R/A
      > R/A/B
      x R/A
      > R/A
      crash
      > R
      > R/A
      > R/A!
      < R/A! done`),
  );
  expect(written(calls)).toBe(
    `R 1-6 dropped
  R/A 2-4 dropped
    R/A/B 3-4 dropped
  R/A 5-6 dropped
R 7- open
  R/A 8-9 dropped
  R/A 9-10 back`,
  );
});

test("however the events are cut, the calls are the same", () => {
  for (let seed = 1; seed <= 20; seed++) {
    const all = randomRun(seed, 300);
    const journal = new Journal();
    const calls = new Calls(journal);
    for (let from = 0; from < all.length; from += 1 + (seed % 7)) {
      journal.add(all.slice(from, from + 1 + (seed % 7)), from + 2);
      calls.follow();
    }
    expect(written(calls)).toBe(written(callsFrom(all)));
  }
});

test("who reads late, after ever so many lines of the log, sees the calls that who read early sees", () => {
  const begun = events(`> R
      > R/A
      x R/A
      > R/B
      crash
      > R`);
  const line = { type: "log", path: "R", level: "info", stream: "stdout", message: "x" } as const;
  const lines = Array.from({ length: 20_001 }, (_, at) => ({
    sequence: begun.length + 1 + at,
    t_ns: 1e9 + at,
    event: line,
  }));
  const journal = new Journal();
  const early = new Calls(journal);
  journal.add(begun, begun.length + 1);
  early.follow();
  journal.add(lines, begun.length + lines.length + 1);
  early.follow();
  const late = new Calls(journal);
  late.follow();
  expect(written(late)).toBe(written(early));
});
