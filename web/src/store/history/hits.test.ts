import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Event } from "../../model/generated/protocol.ts";
import { newBreakpoint } from "../run/breakpoints.ts";
import { hitsOf } from "./hits.ts";
import { Journal } from "./journal.ts";
import type { Watch } from "./run.ts";

test("hits are counted on as the journal grows, and anew when a breakpoint is set again", () => {
  const journal = new Journal();
  const journalVersion = signal(0);
  const watch = { journal, journalVersion } as unknown as Watch;
  const tell = (event: Event) => {
    const sequence = journal.next;
    journal.add([{ sequence, t_ns: sequence, event }], sequence + 1);
    journalVersion.value = journal.length;
  };
  const hit = (hits: number): Event => ({
    type: "hit",
    breakpoint: 1,
    path: "R/A",
    hits,
    held: true,
  });
  expect(hitsOf(watch).size).toBe(0);
  tell(hit(1));
  tell(hit(2));
  expect(hitsOf(watch).get(1)).toBe(2);
  tell({ type: "breakpoint_set", breakpoint: newBreakpoint(1, "R/A") });
  expect(hitsOf(watch).get(1)).toBeUndefined();
  tell(hit(1));
  expect(hitsOf(watch).get(1)).toBe(1);
  tell({ type: "breakpoint_removed", id: 1 });
  expect(hitsOf(watch).size).toBe(0);
});
