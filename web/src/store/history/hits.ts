/** Hit counts of a run's breakpoints, from its journal. Each event is read once. */

import { computed, type ReadonlySignal } from "@preact/signals-core";
import type { Event } from "../../model/generated/protocol.ts";
import { perOwner } from "../../model/per_owner.ts";
import type { Journal } from "./journal.ts";
import type { Watch } from "./run.ts";

interface Tally {
  /** Events before this index are counted. */
  at: number;
  readonly hits: Map<number, number>;
}

const hitsSignal = perOwner((watch: Watch): ReadonlySignal<ReadonlyMap<number, number>> => {
  return computed(() => {
    watch.journalVersion.value;
    const tally = tallyOf(watch.journal);
    readOn(watch, tally);
    return new Map(tally.hits);
  });
});

const tallyOf = perOwner((_journal: Journal): Tally => ({ at: 0, hits: new Map() }));

/** Hits by the breakpoint's id. Reads signals. */
export function hitsOf(watch: Watch): ReadonlyMap<number, number> {
  return hitsSignal(watch).value;
}

function readOn({ journal }: Watch, tally: Tally): void {
  for (; tally.at < journal.length; tally.at += 1) {
    const event = journal.other(tally.at);
    if (event) count(event, tally.hits);
  }
}

function count(event: Event, hits: Map<number, number>): void {
  if (event.type === "hit") hits.set(event.breakpoint, event.hits);
  else if (event.type === "breakpoint_set") hits.delete(event.breakpoint.id);
  else if (event.type === "breakpoint_removed") hits.delete(event.id);
}
