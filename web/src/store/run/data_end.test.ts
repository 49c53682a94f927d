import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { RunNow } from "../../model/generated/protocol.ts";
import { Journal } from "../history/journal.ts";
import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import type { Link } from "../page/server.ts";
import { events } from "../testing/events.ts";
import { runAge } from "./age.ts";
import { elapsedAtDataEnd, extent_ns, silence, sinceSnapshot } from "./data_end.ts";

/** Server time of the snapshot, at which the run had been active for 50 s. The server's clock is an hour ahead. */
const SNAPSHOT_MS = 10_000_000;
const AHEAD_MS = 3_600_000;
const DOWN: Link = { state: "down", since_ms: 0, retry_ms: null, reason: "cut" };

/** Times in seconds after the snapshot. */
interface Given {
  readonly now: number;
  /** Last message of the server. */
  readonly server?: number;
  /** Last contact of the station with the robot; undefined for a run on the server's computer. */
  readonly robot?: number;
  /** Last contact with the program, once it is silent. */
  readonly program?: number;
  readonly link?: RunNow["link"];
  readonly isDown?: boolean;
  readonly playhead?: number;
}

/** `mission time, time in states, age` in seconds. */
function clocks(given: Given): string {
  const at = (seconds: number) => SNAPSHOT_MS + seconds * 1_000;
  const { now: now_s, server = now_s, robot, program, link = "up", playhead } = given;
  const now = {
    run: { phase: "live", started_ms: SNAPSHOT_MS - 50_000, length_ms: 0 },
    link,
    snapshot: { elapsed_ms: 50_000 },
    snapshot_ms: SNAPSHOT_MS,
    runner_heard_ms: at(program ?? robot ?? 0),
    robot: robot === undefined ? null : { heard_ms: at(robot), expected_every_ms: 500 },
  };
  const journal = new Journal();
  const watch = {
    now: signal(now as unknown as RunNow),
    proven_ms: signal(SNAPSHOT_MS),
    isCurrent: signal(true),
    playhead: signal(playhead ?? null),
    journalVersion: signal(0),
    journal,
    window: journal,
  } as unknown as Watch;
  const pulse = { ahead_ms: AHEAD_MS, old_ms: 4_000, server_ms: at(server) };
  const connection = signal(given.isDown ? DOWN : { state: "up" });
  const page = { server: { link: connection, pulse: signal(pulse) } } as unknown as Pick<
    Page,
    "server"
  >;
  const { age_ms } = runAge(page, watch, at(now_s) - AHEAD_MS);
  const shown = [elapsedAtDataEnd(page, watch), sinceSnapshot(page, watch), age_ms];
  return shown.map((ms) => ms / 1_000).join(", ");
}

test("clocks run on with each confirmation by the server, whatever this browser's clock says", () => {
  expect(clocks({ now: 10 })).toBe("60, 10, 0");
  expect(clocks({ now: 10, server: 9 })).toBe("59, 9, 0");
});

test("clocks stop where a station received its robot last, from the first moment of a cut", () => {
  expect(clocks({ now: 10, robot: 10 })).toBe("60, 10, 0");
  expect(clocks({ now: 14, robot: 10 })).toBe("60, 10, 0");
  expect(clocks({ now: 19, robot: 10, link: "silent" })).toBe("60, 10, 9");
  expect(clocks({ now: 37, robot: 10, link: "silent" })).toBe("60, 10, 27");
});

test("clocks stop where the connection to the server was lost, and keep the time in a state", () => {
  expect(clocks({ now: 13, server: 10 })).toBe("60, 10, 0");
  expect(clocks({ now: 15, server: 10 })).toBe("60, 10, 5");
  expect(clocks({ now: 40, server: 10, isDown: true })).toBe("60, 10, 30");
});

test("a lost server does not bring the clocks of a silent robot or program forward", () => {
  const silent = { server: 60, isDown: true, link: "silent" } as const;
  expect(clocks({ now: 70, robot: 10, ...silent })).toBe("60, 10, 60");
  expect(clocks({ now: 70, program: 10, ...silent })).toBe("60, 10, 60");
});

test("a past moment does not change where the data of the run ends", () => {
  expect(clocks({ now: 37, robot: 10, link: "silent", playhead: 0 })).toBe("60, 0, 0");
});

test("a silence is longer than the robot's longest interval and the server's", () => {
  const robot = (seconds: number) => {
    const heard_ms = SNAPSHOT_MS - seconds * 1_000;
    const now = { run: { phase: "live" }, link: "up", robot: { heard_ms, expected_every_ms: 500 } };
    const watch = {
      now: signal(now as unknown as RunNow),
      proven_ms: signal(SNAPSHOT_MS),
      isCurrent: signal(true),
    } as unknown as Watch;
    const pulse = { ahead_ms: 0, old_ms: 4_000, server_ms: SNAPSHOT_MS };
    const server = { link: signal({ state: "up" }), pulse: signal(pulse) };
    return silence({ server } as unknown as Pick<Page, "server">, watch, SNAPSHOT_MS);
  };
  expect(robot(1)).toBeNull();
  expect(robot(4)).toBe(4_000);
});

test("the time in a state that a crash interrupted ends at the crash", () => {
  const run = { phase: "crashed", length_ms: 7_000 };
  const now = { run, snapshot: { elapsed_ms: 1_000 }, snapshot_ms: 5 } as unknown as RunNow;
  const watch = { now: signal(now), playhead: signal(null) } as unknown as Watch;
  const page = { server: { pulse: signal(null) } } as unknown as Page;
  expect(sinceSnapshot(page, watch)).toBe(6_000);
});

test("a time line extends to the end of the data, and at least to the last event", () => {
  const journal = new Journal();
  journal.add(events("> R\n > R/A"), 3);
  const extent = (phase: "live" | "finished", server_ms: number) => {
    const now = {
      run: { phase },
      link: phase === "live" ? "up" : "over",
      snapshot: { elapsed_ms: 0 },
      snapshot_ms: SNAPSHOT_MS,
    };
    const watch = {
      now: signal(now as unknown as RunNow),
      proven_ms: signal(SNAPSHOT_MS + server_ms),
      isCurrent: signal(true),
      journal,
    } as unknown as Watch;
    return extent_ns({ server: { pulse: signal(null) } }, watch) / 1e6;
  };
  expect(extent("live", 7_000)).toBe(7_000);
  expect(extent("live", 0)).toBe(2);
  expect(extent("finished", 7_000)).toBe(2);
});
