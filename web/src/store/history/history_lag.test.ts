import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import { historyLag } from "./history_lag.ts";
import { Journal } from "./journal.ts";
import type { Watch } from "./run.ts";

function missing(received: number, disk_safe: number | null, events: number): number {
  const journal = new Journal();
  journal.add([], received + 1);
  const now = { run: { events }, snapshot: disk_safe === null ? null : { disk_safe } };
  const watch = { journal, journalVersion: signal(0), now: signal(now) };
  return historyLag(watch as unknown as Watch);
}

test("what is on disk and was not told is still to come", () => {
  expect(missing(0, 3_214, 0)).toBe(3_214);
  expect(missing(3_000, 3_214, 3_000)).toBe(214);
  expect(missing(10, null, 25)).toBe(15);
  expect(missing(30, 25, 25)).toBe(0);
});
