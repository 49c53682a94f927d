import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Phase, RunNow } from "../../model/generated/protocol.ts";
import { Counts } from "../history/counts.ts";
import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import { longerThanEver } from "./longer.ts";

/** Which states run longer than ever, of one that took 2 s so often and has been active for so long. */
function longer(times: number, since_ms: number, phase: Phase = "running", link = "up"): string {
  const counts = new Counts();
  for (let time = 0; time < times; time += 1) {
    counts.entered(1, "R/A", 0, false);
    counts.left(1, "R/A", 2e9, { id: 0, name: "success" }, false);
  }
  const state = { path: "R/A", name: "A", phase, since_ms, branch: "", detail: null, held: [] };
  const run = { id: "r", phase: "live", machine: null };
  const now = { run, link, snapshot: { active: [state], questions: [] }, snapshot_ms: null };
  const watch = {
    id: "r",
    now: signal(now as unknown as RunNow),
    playhead: signal(null),
    isCurrent: signal(true),
    proven_ms: signal(0),
    journal: { counts },
  };
  const server = { link: signal({ state: "up" }), pulse: signal(null) };
  const page = { server, runs: { all: signal([]) } } as unknown as Page;
  const found = longerThanEver(page, watch as unknown as Watch);
  return found.map(({ path, baseline }) => `${path} ${baseline.max_ms}`).join();
}

test("a state at work is told when it takes longer than ever, of five times at least", () => {
  expect(longer(5, 9_000)).toBe("R/A 2000");
  expect([longer(5, 2_500), longer(4, 9_000)]).toEqual(["", ""]);
});

test("nothing is told of what waits for someone, or of a run that is not heard", () => {
  expect([longer(5, 9_000, "waiting"), longer(5, 9_000, "running", "silent")]).toEqual(["", ""]);
});
