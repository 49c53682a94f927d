import { signal } from "@preact/signals-core";
import { describe, expect, it } from "vitest";
import type { RunNow } from "../../model/generated/protocol.ts";
import { Journal } from "../history/journal.ts";
import type { Watch } from "../history/run.ts";
import type { Link, ServerPulse } from "../page/server.ts";
import { runAge } from "./age.ts";

const NOW_MS = 1_000_000;
const DOWN: Link = { state: "down", since_ms: NOW_MS - 2_000, retry_ms: null, reason: "cut" };
const UP = { state: "up" } as Link;

interface Given {
  readonly link?: Link;
  readonly phase?: "live" | "finished";
  readonly runner?: RunNow["link"];
  /** Time of the last message by this browser's clock. */
  readonly server_ms?: number;
  readonly old_ms?: number;
  readonly ahead_ms?: number;
  readonly playhead?: number;
  readonly isCurrent?: boolean;
}

function age(given: Given) {
  const { link = UP, phase = "live", runner = "up", server_ms = NOW_MS - 500 } = given;
  const { ahead_ms = 0 } = given;
  const run = { phase, started_ms: 0 };
  const [snapshot_ms, runner_heard_ms] = [NOW_MS - 90_000, NOW_MS - 3_000];
  const now = { run, link: runner, snapshot_ms, runner_heard_ms, now_ms: NOW_MS } as RunNow;
  const journal = new Journal();
  journal.add(
    [1, 2, 3].map((sequence) => ({
      sequence,
      t_ns: sequence * 1e9,
      event: { type: "entered", path: "R" },
    })),
    4,
  );
  const watch = {
    now: signal(now),
    proven_ms: signal(NOW_MS + ahead_ms - 7_000),
    isCurrent: signal(given.isCurrent ?? true),
    playhead: signal(given.playhead ?? null),
    journalVersion: signal(3),
    journal,
    window: journal,
  } as unknown as Watch;
  const times = {
    heard_ms: NOW_MS,
    server_ms: server_ms + ahead_ms,
    old_ms: given.old_ms ?? 4_000,
  };
  const pulse: ServerPulse = { ...times, delay_ms: 3, ahead_ms };
  const server = { link: signal(link), pulse: signal(pulse) };
  return runAge({ server } as unknown as Parameters<typeof runAge>[0], watch, NOW_MS);
}

describe("what is shown of a run", () => {
  it("is fresh while server and runner are heard, however long nothing happens", () => {
    expect(age({})).toEqual({ age_ms: 0, isOld: false, why: null });
  });

  it("is as old as what the server said last, also when that was held back on the way", () => {
    expect(age({ link: DOWN })).toEqual({ age_ms: 500, isOld: true, why: "link" });
    const silent = { server_ms: NOW_MS - 9_000 };
    expect(age({ ...silent, isCurrent: true })).toEqual({
      age_ms: 7_000,
      isOld: true,
      why: "link",
    });
  });

  it("is not old on a slow network before the delay says so", () => {
    const slow = { server_ms: NOW_MS - 6_000, old_ms: 9_000, ahead_ms: -2_000 };
    expect(age(slow)).toEqual({ age_ms: 0, isOld: false, why: null });
    expect(age({ ...slow, old_ms: 4_000 })).toEqual({ age_ms: 6_000, isOld: true, why: "link" });
  });

  it("is old until the server has told it over the connection that there is now", () => {
    expect(age({ isCurrent: false, server_ms: NOW_MS })).toEqual({
      age_ms: 7_000,
      isOld: true,
      why: "link",
    });
  });

  it("is as old as the runner was heard last by the server, by the server's clock", () => {
    const runner = "down" as const;
    expect(age({ runner })).toEqual({ age_ms: 3_000, isOld: true, why: "runner" });
    expect(age({ runner, ahead_ms: 60_000 }).age_ms).toBe(63_000);
    expect(age({ runner, ahead_ms: -60_000 }).age_ms).toBe(500);
  });

  it("is as old as its program has been silent, however long ago that had something to say", () => {
    const runner = "silent" as const;
    expect(age({ runner })).toEqual({ age_ms: 3_000, isOld: true, why: "silence" });
    expect(age({ runner: "stuck" })).toEqual({ age_ms: 3_000, isOld: true, why: "engine" });
    expect(age({ runner, ahead_ms: 60_000 }).age_ms).toBe(63_000);
    expect(age({ runner, link: DOWN }).why).toBe("link");
  });

  it("is never old once the run is over", () => {
    const phase = "finished" as const;
    expect(age({ phase, link: DOWN, runner: "over" }).isOld).toBe(false);
  });

  it("is a moment of the past if that was asked for, and not greyed", () => {
    expect(age({ playhead: 1, link: DOWN })).toEqual({
      age_ms: 2_000,
      isOld: false,
      why: "moment",
    });
  });
});
