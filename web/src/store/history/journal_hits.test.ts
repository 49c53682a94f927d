import { expect, test } from "vitest";
import { Journal } from "./journal.ts";
import { JournalHits } from "./journal_hits.ts";

test("a search ends at the bound of its hits, and a narrower one finds what comes after", () => {
  const journal = new Journal();
  const path = (at: number) => (at < 20_000 ? "R/Step" : "R/Step last");
  const entries = Array.from({ length: 20_001 }, (_, at) => {
    return { sequence: at + 1, t_ns: at, event: { type: "entered", path: path(at) } as const };
  });
  const found = (wanted: string) => {
    const search = new JournalHits(journal, wanted, (name) => name);
    search.follow();
    return [search.hits.length, search.hits.at(-1), search.isFull];
  };
  journal.add(entries.slice(0, 19_999), 20_000);
  expect(found("step")).toEqual([19_999, 19_998, false]);
  journal.add(entries, 20_002);
  expect(found("step")).toEqual([20_000, 19_999, true]);
  expect(found("last")).toEqual([1, 20_000, false]);
});
