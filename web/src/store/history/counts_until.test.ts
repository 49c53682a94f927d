import fc from "fast-check";
import { expect, test } from "vitest";
import type { HistoryEntry } from "../../model/generated/protocol.ts";
import { events, randomRun } from "../testing/events.ts";
import { countsUntil } from "./counts_until.ts";
import { Journal } from "./journal.ts";
import { statisticsUntil } from "./statistics_until.ts";

function journalOf(entries: readonly HistoryEntry[]): Journal {
  const journal = new Journal();
  journal.add(entries, entries.length + 1);
  return journal;
}

test("steps back do not count, and what is in progress has taken no time yet", () => {
  const journal = journalOf(events("> R\n> R/A\n< R/A\n> R/A\n< R/A\n> R/A!\n< R/A!"));
  const at = (index: number) => {
    const all = [...countsUntil(journal, index).all()].filter(({ entries }) => entries > 0);
    return all.map(({ path, entries, total_ns }) => `${path} ${entries}x ${total_ns / 1e6}`);
  };
  expect([at(2), at(7), at(3), at(0)]).toEqual([
    ["R 1x 0", "R/A 1x 0"],
    ["R 1x 0", "R/A 2x 2"],
    ["R 1x 0", "R/A 1x 1"],
    [],
  ]);
});

test("states are told with their times and outcomes, the most frequent first", () => {
  const journal = journalOf(
    events("> R\n> R/A\n< R/A ok\n> R/A\n= R/A slow\n< R/A aborted\n> R/A\n< R/A ok"),
  );
  const words = (index: number) =>
    statisticsUntil(journal, index).map(
      ({ path, count, total_ns, min_ns, median_ns, p95_ns, max_ns, outcomes }) =>
        [
          path,
          count,
          ...[total_ns, min_ns, median_ns, p95_ns, max_ns].map((ns) => ns / 1e6),
          ...outcomes.map(({ outcome, count: often }) => `${outcome.name} ${often}`),
        ].join(" "),
    );
  expect([words(2), words(3), words(8), words(6)]).toEqual([
    [],
    ["R/A 1 1 1 1 1 1 ok 1"],
    ["R/A 3 4 1 1 2 2 ok 2, aborted 1".replace(",", "")],
    ["R/A 2 3 1 1 2 2 aborted 1 ok 1"],
  ]);
});

/** Counts from the first event on, without a cache. */
function fromScratch(journal: Journal, index: number): readonly string[] {
  const since = new Map<string, number>();
  const lengths = new Map<string, number[]>();
  for (let at = 0; at < index; at += 1) {
    const event = journal.at(at);
    if (event?.kind === "entered") since.set(event.path, event.t_ns);
    if (event?.kind !== "left") continue;
    const all = lengths.get(event.path) ?? [];
    lengths.set(event.path, [...all, event.t_ns - (since.get(event.path) ?? 0)]);
  }
  const rank = (all: readonly number[], part: number) => all[Math.ceil(all.length * part) - 1];
  return [...lengths]
    .map(([path, all]) => {
      const sorted = [...all].sort((one, other) => one - other);
      const total = all.reduce((sum, length) => sum + length, 0);
      return [path, all.length, total, sorted[0], rank(sorted, 0.5), rank(sorted, 0.95)].join(" ");
    })
    .sort();
}

test("at any moment, from any other one, all is as if it were counted from scratch", () => {
  const journal = journalOf(randomRun(7, 1_500));
  const moment = fc.nat(journal.length);
  const near = fc.integer({ min: -40, max: 40 });
  fc.assert(
    fc.property(fc.array(fc.tuple(moment, near), { maxLength: 8 }), (steps) => {
      for (const [far, by] of steps) {
        for (const index of [far, Math.max(0, Math.min(journal.length, far + by))]) {
          const before = new Journal();
          const earlier = randomRun(7, 1_500).slice(0, index);
          before.add(earlier, index + 1);
          const [entries, totals] = [new Map<string, number>(), new Map<string, number>()];
          for (const count of countsUntil(journal, index).all()) {
            entries.set(count.path, count.entries);
            totals.set(count.path, count.total_ns);
          }
          for (const { path, entries: often, total_ns } of before.counts.all()) {
            expect([path, entries.get(path), totals.get(path)]).toEqual([path, often, total_ns]);
          }
          const rows = statisticsUntil(journal, index).map((row) =>
            [row.path, row.count, row.total_ns, row.min_ns, row.median_ns, row.p95_ns].join(" "),
          );
          expect([...rows].sort()).toEqual(fromScratch(journal, index));
        }
      }
    }),
    { numRuns: 30 },
  );
});

test("rows of states that did nothing since are the same objects", () => {
  const journal = journalOf(events("> R\n> R/A\n< R/A\n> R/B\n< R/B\n> R/B\n< R/B"));
  const [a, b] = statisticsUntil(journal, 5);
  const [again, other] = statisticsUntil(journal, 7);
  expect([again === a, other === b]).toEqual([true, false]);
});
