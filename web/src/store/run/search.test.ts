import { expect, test } from "vitest";
import type { EventPage } from "../../model/generated/protocol.ts";
import { Journal } from "../history/journal.ts";
import { events } from "../testing/events.ts";
import { RunSearch } from "./search.ts";

const TOLD = events("> R\n> R/A\n< R/A seen\n> R/A\n< R/A seen\n> R/B");

async function settle(): Promise<void> {
  for (let turn = 0; turn < 20; turn += 1) await Promise.resolve();
}

function sequences(search: RunSearch): readonly number[] {
  return Array.from({ length: search.count }, (_, place) => search.sequence(place));
}

function searched(journal: Journal, pages: readonly EventPage[] = []) {
  const asked: string[] = [];
  const left = [...pages];
  const get = (async (_run: string, what: string) => {
    asked.push(what);
    const page = left.shift();
    if (!page) throw new Error(`nobody expected ${what}`);
    return page;
  }) as <T>(run: string, what: string) => Promise<T>;
  const watch = { id: "r", journal, whenClosed: () => {} };
  const search = new RunSearch(watch, { get }, "R/A", (path) => path);
  return { search, asked };
}

test("a run that is here as a whole is searched here, and one goes from hit to hit and around", () => {
  const journal = new Journal();
  journal.add(TOLD, 7);
  const { search } = searched(journal);
  expect(sequences(search)).toEqual([2, 4]);
  expect([search.after(1), search.after(2), search.after(4)]).toEqual([0, 1, 0]);
  expect([search.before(4), search.before(2), search.before(9)]).toEqual([0, 1, 1]);
  journal.add([{ sequence: 7, t_ns: 7e6, event: { type: "entered", path: "R/A" } }], 8);
  search.follow();
  expect(sequences(search)).toEqual([2, 4, 7]);
});

test("of a long run the server searches all, page by page, and goes on when it grows", async () => {
  const base = { before: { sequence: 1_000, t_ns: 0, active: [] }, earlier: null };
  const journal = new Journal(base);
  const hit = (sequence: number) => {
    return { sequence, t_ns: sequence, event: { type: "entered", path: "R/A" } as const };
  };
  const { search, asked } = searched(journal, [
    { events: [hit(2), hit(4)], next: 500, last: 1_000 },
    { events: [hit(700)], next: 1_001, last: 1_000 },
    { events: [hit(1_001)], next: 1_002, last: 1_001 },
  ]);
  expect([search.isAsking, search.count]).toEqual([true, 0]);
  await settle();
  expect(asked).toEqual(["hits?text=R%2FA&from=1", "hits?text=R%2FA&from=500"]);
  expect([search.isAsking, ...sequences(search)]).toEqual([false, 2, 4, 700]);
  expect(search.at(2)).toMatchObject({ kind: "entered", path: "R/A", sequence: 700 });
  search.follow();
  expect(asked.length).toBe(2);
  journal.add([hit(1_001)], 1_002);
  search.follow();
  await settle();
  expect(sequences(search)).toEqual([2, 4, 700, 1_001]);
});
