import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import { events } from "../testing/events.ts";
import { Journal } from "./journal.ts";
import { JournalHits } from "./journal_hits.ts";
import { entryToStartFrom, shownIndex, showTime, stepPlayhead, toEnd, toEntry } from "./moments.ts";
import { Notes } from "./notes.ts";
import type { Watch } from "./run.ts";

const TOLD = `> R
  > R/A
  = R/A hello
  < R/A seen
  > R/B
  ! R/B look out
  < R/B done
  > R/A
  < R/A done`;

function watched(text = TOLD): Watch {
  const journal = new Journal();
  const entries = events(text);
  journal.add(entries, entries.length + 1);
  return { journal, window: journal, playhead: signal<number | null>(null) } as unknown as Watch;
}

test("one goes event by event, and beyond the last one is live", () => {
  const watch = watched();
  stepPlayhead(watch, 1);
  expect(watch.playhead.value).toBeNull();
  stepPlayhead(watch, -1);
  expect(watch.playhead.value).toBe(8);
  stepPlayhead(watch, -20);
  expect(watch.playhead.value).toBe(1);
  stepPlayhead(watch, 1);
  expect([watch.playhead.value, shownIndex(watch)]).toEqual([2, 1]);
  stepPlayhead(watch, 20);
  expect(watch.playhead.value).toBeNull();
  toEnd(watch, "first");
  expect(watch.playhead.value).toBe(1);
});

test("one goes from entry to entry of a state, and to times", () => {
  const watch = watched();
  expect(toEntry(watch, "R/A", "after")).toBe(false);
  expect(toEntry(watch, "R/A", "before")).toBe(true);
  expect(watch.playhead.value).toBe(8);
  toEntry(watch, "R/A", "before");
  expect(watch.playhead.value).toBe(2);
  expect(toEntry(watch, "R/A", "before")).toBe(false);
  toEntry(watch, "R/A", "after");
  expect(watch.playhead.value).toBe(8);
  showTime(watch, 4.5e6);
  expect(watch.playhead.value).toBe(4);
});

test("a run continues from a moment by the next entry, else by what ran then", () => {
  const watch = watched();
  watch.playhead.value = 4;
  expect(entryToStartFrom(watch)).toBe(5);
  watch.playhead.value = 2;
  expect(entryToStartFrom(watch)).toBe(2);
  watch.playhead.value = null;
  expect(entryToStartFrom(watch)).toBe(1);
});

test("states, outcomes and texts are found, also while the journal grows", () => {
  const { journal } = watched();
  const name = (path: string) => (path === "R/A" ? "Look around" : path);
  const hits = (words: string) => {
    const found = new JournalHits(journal, words, name);
    found.follow();
    return found.hits.map((index) => journal.sequence(index));
  };
  expect(hits("look")).toEqual([2, 6, 8]);
  expect(hits("SEEN")).toEqual([4]);
  expect(hits(" ")).toEqual([]);
  const found = new JournalHits(journal, "look", name);
  found.follow();
  journal.add([{ sequence: 10, t_ns: 10e6, event: { type: "entered", path: "R/A" } }], 11);
  found.follow();
  expect(found.hits).toEqual([1, 5, 7, 9]);
});

test("what is worth a mark is noted once", () => {
  const { journal } = watched(`${TOLD}\ncrash`);
  const notes = new Notes(journal);
  notes.follow();
  notes.follow();
  expect(notes.all).toEqual([
    { index: 5, kind: "warning" },
    { index: 9, kind: "crash" },
  ]);
  expect([notes.firstFrom(0), notes.firstFrom(6), notes.firstFrom(10)]).toEqual([0, 1, 2]);
});
