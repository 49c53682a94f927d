/** A watched run without a server, for tests: the test sets its status and adds its events. */

import { signal } from "@preact/signals-core";
import type { Event, RunNow, RunSummary } from "../../model/generated/protocol.ts";
import { NOTHING_AHEAD } from "../history/ahead.ts";
import { Journal } from "../history/journal.ts";
import type { SentCommand, Watch } from "../history/run.ts";

export const STARTED_MS = 1_000_000;

/** Summary of a run of the machine that `commands/testing/context.ts` puts in front. */
export function runLine(phase: "live" | "crashed" | "finished", id = "drill-1"): RunSummary {
  const machine = { project: "p", path: "drill" };
  const times = { started_ms: STARTED_MS, length_ms: 83, events: 4, bytes: 100 };
  const line = { id, name: "Drill", machine, author: null, keeping: "full", waits: null, ...times };
  const end = phase === "finished" ? { outcome: { id: 0, name: "success" }, states_run: 3 } : {};
  return { ...line, ...end, phase } as RunSummary;
}

export interface Watched {
  readonly watch: Watch;
  /** Adds events at intervals of one millisecond. */
  readonly tell: (...events: readonly Event[]) => void;
}

export function watched(run: RunSummary, more: Partial<RunNow> = {}): Watched {
  const journal = new Journal();
  const journalVersion = signal(0);
  const control = { holder: null, since_ms: 0, heard_ms: 0, silence_ms: 30_000, asking: [] };
  const plain = { run, link: "up", control, snapshot: null, snapshot_ms: null };
  const now = { ...plain, ...more } as unknown as RunNow;
  const watch = {
    id: run.id,
    now: signal<RunNow | null>(now),
    proven_ms: signal(STARTED_MS),
    isCurrent: signal(true),
    journal,
    window: journal,
    journalVersion,
    isCaughtUp: signal(true),
    lack: signal<string | null>(null),
    playhead: signal<number | null>(null),
    playheadSnapshot: signal(null),
    sent: signal<readonly SentCommand[]>([]),
    ahead: signal(NOTHING_AHEAD),
    whenClosed: () => {},
  } as unknown as Watch;
  const tell = (...events: readonly Event[]) => {
    const from = journal.next;
    const entries = events.map((event, at) => ({
      sequence: from + at,
      t_ns: (from + at) * 1e6,
      event,
    }));
    journal.add(entries, from + events.length);
    journalVersion.value = journal.length;
  };
  return { watch, tell };
}
