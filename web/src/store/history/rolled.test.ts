import fc from "fast-check";
import { expect, test } from "vitest";
import type { HistoryEntry } from "../../model/generated/protocol.ts";
import { events, randomRun } from "../testing/events.ts";
import { callsOf } from "./calls.ts";
import { countsUntil } from "./counts_until.ts";
import { Journal } from "./journal.ts";
import { lookOf } from "./lanes.ts";
import { rolled, withBase } from "./rolled.ts";
import { visitsOf } from "./visits.ts";

function journalOf(entries: readonly HistoryEntry[]): Journal {
  const journal = new Journal();
  journal.add(entries, entries.length + 1);
  return journal;
}

/** The received events, without earlier ones. */
function entriesOf(journal: Journal): readonly string[] {
  return Array.from({ length: journal.length - journal.first }, (_, index) => {
    return JSON.stringify(journal.at(journal.first + index));
  });
}

function counts(journal: Journal, sequence: number): readonly string[] {
  const all = countsUntil(journal, journal.indexOf(sequence + 1)).all();
  return [...all]
    .filter(({ entries, total_ns }) => entries > 0 || total_ns > 0)
    .map(({ path, entries, total_ns }) => `${path} ${entries} ${Math.round(total_ns)}`)
    .sort();
}

/** Calls that are open or end from an event on. */
function callsFrom(journal: Journal, sequence: number): readonly string[] {
  const calls = callsOf(journal);
  const found: string[] = [];
  for (let call = 0; call < calls.length; call += 1) {
    const end = calls.end(call);
    if (end >= 0 && journal.sequence(end) < sequence) continue;
    const [begin, to] = [journal.sequence(calls.begin(call)), end < 0 ? 0 : journal.sequence(end)];
    found.push(`${calls.path(call)} ${begin}-${to} ${lookOf(calls, call)} ${calls.depth(call)}`);
  }
  return found;
}

test("a run that goes on as its newest events has the same calls, counts and visits as all of it", () => {
  fc.assert(
    fc.property(
      fc.integer({ min: 1, max: 60 }),
      fc.integer({ min: 1, max: 200 }),
      (seed, newest) => {
        const whole = journalOf(randomRun(seed, 250));
        const part = rolled(whole, newest);
        expect(part.length - part.first).toBe(Math.min(newest, whole.length));
        expect(part.next).toBe(whole.next);
        expect(entriesOf(part)).toEqual(entriesOf(whole).slice(-newest));
        expect(callsFrom(part, part.from)).toEqual(callsFrom(whole, part.from));
        for (const sequence of [part.from, whole.next - 1]) {
          expect(counts(part, sequence)).toEqual(counts(whole, sequence));
        }
        for (const { path, entries, left_ns } of whole.counts.all()) {
          expect([path, part.counts.get(path)?.entries]).toEqual([path, entries]);
          expect([path, part.counts.get(path)?.left_ns ?? null]).toEqual([path, left_ns]);
          const [here, all] = [visitsOf({ window: part }), visitsOf({ window: whole })];
          expect(here.last("left", path, null)).toBe(all.last("left", path, null));
          expect(here.count(path, null)).toBe(all.count(path, null));
        }
        expect(rolled(rolled(whole, newest + 20), newest).base?.earlier?.states.length).toBe(
          part.base?.earlier?.states.length,
        );
      },
    ),
  );
});

test("what is worth a mark is kept from before, and what is learnt of before changes nothing else", () => {
  const whole = journalOf(events("> R\n> R/A\n! R/A look out\n< R/A aborted\n> R/B\n< R/B done"));
  const part = rolled(whole, 2);
  const { before, earlier } = part.base ?? { before: null, earlier: null };
  expect(earlier?.notable.map(({ sequence }) => sequence)).toEqual([3, 4]);
  expect(before?.active.map(({ path }) => path)).toEqual(["R"]);
  if (!before) throw new Error("a part has something before it");
  const bare = withBase(part, { before, earlier: null });
  expect(entriesOf(bare)).toEqual(entriesOf(part));
  expect(callsFrom(bare, 5)).toEqual(callsFrom(part, 5));
  expect([bare.first, part.first]).toEqual([1, 3]);
});

test("of more than 5,000 marks from before the oldest goes", () => {
  const warned = (count: number) => {
    const text = Array.from({ length: count }, (_, at) => `! R/A ${at + 1}`);
    const part = rolled(journalOf(events([...text, "> R/B"].join("\n"))), 1);
    const notable = part.base?.earlier?.notable ?? [];
    return [notable.length, notable[0]?.sequence, notable.at(-1)?.sequence];
  };
  expect(warned(5_000)).toEqual([5_000, 1, 5_000]);
  expect(warned(5_001)).toEqual([5_000, 2, 5_001]);
});
