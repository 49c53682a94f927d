import { expect, test } from "vitest";
import type { HistoryEntry } from "../../model/generated/protocol.ts";
import { Journal } from "../history/journal.ts";
import { heatOf } from "./heat.ts";

/** Entries of each state, and ms per entry. */
function ran(states: Readonly<Record<string, readonly [number, number]>>): Journal {
  const journal = new Journal();
  const entries: HistoryEntry[] = [];
  let t_ns = 0;
  for (const [path, [times, ms]] of Object.entries(states)) {
    for (let time = 0; time < times; time++) {
      entries.push({ sequence: entries.length + 1, t_ns, event: { type: "entered", path } });
      t_ns += ms * 1e6;
      const outcome = { id: 0, name: "ok" };
      entries.push({ sequence: entries.length + 1, t_ns, event: { type: "left", path, outcome } });
    }
  }
  journal.add(entries, entries.length + 1);
  return journal;
}

test("states are as hot as they were run often, or long; containers do not hide it", () => {
  const journal = ran({ R: [1, 90_000], "R/A": [1, 1_000], "R/B": [1_000, 0.01], "R/C": [30, 1] });
  const often = heatOf(journal.counts.all(), "count", 5);
  expect(often.most).toBe(1_000);
  expect([...often.levels].join(" ")).toBe("R,1 R/A,1 R/B,5 R/C,2");
  const long = heatOf(journal.counts.all(), "time", 5);
  expect(long.most).toBe(1_000);
  expect([...long.levels].join(" ")).toBe("R,5 R/A,5 R/B,2 R/C,2");
});

test("where nothing ran nothing is hot", () => {
  expect(heatOf(new Journal().counts.all(), "time", 5).levels.size).toBe(0);
});
