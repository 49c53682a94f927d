import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Phase, RunNow } from "../../model/generated/protocol.ts";
import { Counts } from "../history/counts.ts";
import type { Watch } from "../history/run.ts";
import { clock1s } from "../page/clock1s.ts";
import type { Page } from "../page/page.ts";
import { longerThanEver } from "./longer.ts";

interface Given {
  readonly times?: number;
  /** At the latest snapshot. */
  readonly since_ms: number;
  readonly phase?: Phase;
  readonly link?: "up" | "silent";
  /** The time since the snapshot, and the part of it until the server and the robot were received last, in ms. */
  readonly later_ms?: number;
  readonly server_ms?: number;
  readonly robot_ms?: number;
  /** Number of events that the robot has and the station lacks. */
  readonly missing?: number;
}

/** States that run longer than ever after this number of runs of 2 s; `unknown` while undetermined. */
function longer(given: Given): string {
  const { times = 5, since_ms, phase = "running", link = "up", later_ms = 0 } = given;
  const { server_ms = later_ms, robot_ms, missing = 0 } = given;

  const counts = new Counts();
  for (let time = 0; time < times; time += 1) {
    counts.entered(1, "R/A", 0, false);
    counts.left(1, "R/A", 2e9, { id: 0, name: "success" }, false);
  }
  const state = { path: "R/A", name: "A", phase, since_ms, branch: "", detail: null, held: [] };
  const run = { id: "r", phase: "live", machine: null, events: 9 };
  const snapshot = { active: [state], questions: [], sequence: 9 };
  const snapshot_ms = clock1s.peek() - later_ms;
  const robot = robot_ms === undefined ? null : { heard_ms: snapshot_ms + robot_ms, missing };
  const now = { run, link, snapshot, snapshot_ms, robot };
  const watch = {
    id: "r",
    now: signal(now as unknown as RunNow),
    playhead: signal(null),
    isCurrent: signal(true),
    proven_ms: signal(snapshot_ms),
    journal: { counts, next: 10 },
  };
  const pulse = { ahead_ms: 0, old_ms: 4_000, server_ms: snapshot_ms + server_ms };
  const server = { link: signal({ state: "up" }), pulse: signal(pulse) };
  const page = { server, runs: { all: signal([]) } } as unknown as Page;
  const found = longerThanEver(page, watch as unknown as Watch);
  if (found === null) return "unknown";
  return found.map(({ path, baseline }) => `${path} ${baseline.max_ms}`).join();
}

test("a state at work is reported when it takes longer than ever, of five times at least", () => {
  expect(longer({ since_ms: 9_000 })).toBe("R/A 2000");
  expect([longer({ since_ms: 2_500 }), longer({ times: 4, since_ms: 9_000 })]).toEqual(["", ""]);
});

test("nothing is reported of what waits for someone, or of a run that is not received", () => {
  expect(longer({ since_ms: 9_000, phase: "waiting" })).toBe("");
  expect(longer({ since_ms: 9_000, link: "silent" })).toBe("unknown");
});

test("time in which nothing was received does not count, neither of the server nor of a robot", () => {
  const since = { since_ms: 1_000, later_ms: 3_500 };
  expect(longer(since)).toBe("R/A 2000");
  expect(longer({ ...since, server_ms: 200 })).toBe("");
  expect(longer({ ...since, robot_ms: 200 })).toBe("");
  expect(longer({ since_ms: 9_000, later_ms: 5_000, server_ms: 200 })).toBe("unknown");
});

test("after a silence nothing is reported until the robot has sent the state after its newest event", () => {
  const since = { since_ms: 1_000, later_ms: 60_000, robot_ms: 60_000 };
  expect(longer(since)).toBe("R/A 2000");
  expect(longer({ ...since, missing: 3 })).toBe("unknown");
});
