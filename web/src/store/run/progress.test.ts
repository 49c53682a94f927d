import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { RunNow } from "../../model/generated/protocol.ts";
import { Journal } from "../history/journal.ts";
import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import { events } from "../testing/events.ts";
import { progressAt } from "./progress.ts";

const NOW_MS = 100_000;

interface Given {
  readonly phase?: "live" | "finished";
  readonly playhead?: number;
  /** Time of the last message from the server. */
  readonly heard_ms?: number;
}

/** Its runner was last received five seconds ago, two seconds after the start. Its last event is older. */
function come({ phase = "live", playhead, heard_ms = NOW_MS }: Given): number {
  const journal = new Journal();
  journal.add(events("> R\n > R/A"), 3);
  const now = {
    run: { phase },
    link: phase === "live" ? "up" : "over",
    snapshot: { elapsed_ms: 2_000 },
    snapshot_ms: NOW_MS - 5_000,
  };
  const watch = {
    now: signal(now as RunNow),
    proven_ms: signal(heard_ms),
    isCurrent: signal(true),
    playhead: signal(playhead ?? null),
    journal,
  };
  const server = {
    link: signal({ state: "up" }),
    pulse: signal({ heard_ms, delay_ms: 1, ahead_ms: 0, server_ms: heard_ms, old_ms: 4_000 }),
  };
  return progressAt({ server } as unknown as Page, watch as unknown as Watch, NOW_MS);
}

test("a run in progress comes farther also while nothing happens, whatever moment is shown", () => {
  expect(come({})).toBe(7_000);
  expect(come({ playhead: 1 })).toBe(7_000);
});

test("it has come as far as it was heard, and one that is over to its last event", () => {
  expect(come({ heard_ms: NOW_MS - 4_500 })).toBe(2_500);
  expect(come({ phase: "finished" })).toBe(2);
});
