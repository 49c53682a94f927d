/** Whether a page was told every event of a run once: what it has in its columns against what the server has on disk. */

import type { Page as Sheet } from "playwright-core";
import type { Server } from "../e2e/support/server.ts";
import type { EventPage } from "../src/model/generated/protocol.ts";

/** An event in short. */
export interface PageEvent {
  readonly sequence: number;
  /** `entered`, `left`, or another type. */
  readonly kind: string;
  /** The state that was entered or left. */
  readonly path: string;
}

/** The same with its time since the run began. */
export interface Kept extends PageEvent {
  readonly t_ns: number;
}

/** All events of a run as the server has them on disk, without those that are only about values. */
export async function theJournal(server: Server, run: string): Promise<readonly Kept[]> {
  const events: Kept[] = [];
  for (let from = 1; ; ) {
    const page = await server.ask<EventPage>("GET", `/runs/${run}/events?from=${from}`);
    for (const { sequence, t_ns, event } of page.events) {
      const isState = event.type === "entered" || event.type === "left";
      events.push({ sequence, t_ns, kind: event.type, path: isState ? event.path : "" });
    }
    if (page.next > page.last) return events;
    from = page.next;
  }
}

/** All events that the page has, once it has the last. */
export async function thePage(sheet: Sheet, last: number): Promise<readonly PageEvent[]> {
  await sheet.waitForFunction(
    (wanted) => (window.__rafcon.page.active.value?.run.value?.journal.next ?? 0) > wanted,
    last,
  );
  return sheet.evaluate(() => {
    const journal = window.__rafcon.page.active.value?.run.value?.journal;
    return Array.from({ length: journal?.length ?? 0 }, (_, index) => {
      const found = journal?.at(index);
      const sequence = journal?.sequence(index) ?? 0;
      if (!found) return { sequence, kind: "", path: "" };
      if (found.kind === "other") return { sequence, kind: found.event.type, path: "" };
      return { sequence, kind: found.kind, path: found.path };
    });
  });
}

/** Each difference in words. */
export function compared(
  page: readonly PageEvent[],
  journal: readonly PageEvent[],
): readonly string[] {
  const differences: string[] = [];
  const known = new Map<number, PageEvent>();
  for (const received of page) {
    if (known.has(received.sequence))
      differences.push(`event ${received.sequence} was received twice`);
    known.set(received.sequence, received);
  }
  for (const kept of journal) {
    const received = known.get(kept.sequence);
    known.delete(kept.sequence);
    if (!received) differences.push(`event ${kept.sequence} is missing: ${inWords(kept)}`);
    // Of what is neither entry nor end the page keeps the newest only.
    else if (received.kind !== "" && inWords(received) !== inWords(kept)) {
      differences.push(
        `event ${kept.sequence} is ${inWords(received)} instead of ${inWords(kept)}`,
      );
    }
  }
  for (const received of known.values()) {
    differences.push(`event ${received.sequence} never was: ${inWords(received)}`);
  }
  return differences;
}

function inWords({ kind, path }: PageEvent): string {
  return `${kind} ${path}`.trim();
}
