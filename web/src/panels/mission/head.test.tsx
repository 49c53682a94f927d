// @vitest-environment happy-dom
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { RunNow, RunSummary } from "../../model/generated/protocol.ts";
import { runLine, STARTED_MS, watched } from "../../store/testing/watched.ts";
import { settled, unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { Branches } from "./branches.tsx";
import { Crash } from "./crash.tsx";
import { Head } from "./head.tsx";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  unmount();
  vi.useRealTimers();
});

/** The times at the head of mission control, a minute after the last snapshot. */
async function times(run: RunSummary, more: Partial<RunNow>): Promise<string> {
  vi.setSystemTime(STARTED_MS + 90_000);
  const snapshot = { status: "running", active: [], questions: [], elapsed_ms: 30_000 };
  const now = { snapshot, snapshot_ms: STARTED_MS + 30_000, ...more } as unknown as RunNow;
  const { watch } = watched(run, now);
  const place = shown(<Head watch={watch} />, { watch });
  await settled();
  const large = place.querySelector(".mission-times")?.textContent;
  return `${large} | ${place.querySelector(".mission-clocks")?.textContent}`;
}

test("of a run of this computer the head says mission time and UTC", async () => {
  expect(await times(runLine("live"), {})).toBe("mission timeT+00:01:30 | UTC 00:18:10");
});

test("of a robot's run it says UTC within its bound and the robot's clock; in a blackout all as of when it was heard", async () => {
  const run = { ...runLine("live"), robot: "scout" };
  const robot = { clock: { least_ms: 1_000, most_ms: 3_000 } } as unknown as RunNow["robot"];
  const clocks = "UTC 00:18:08 ± 1.0 sscout’s clock 00:18:10";
  expect(await times(run, { robot } as Partial<RunNow>)).toBe(`mission timeT+00:01:30 | ${clocks}`);
  const dark = { robot, link: "silent", runner_heard_ms: STARTED_MS + 50_000 } as Partial<RunNow>;
  expect(await times(run, dark)).toBe(
    "mission time, 40 s agoT+00:00:50 | UTC 00:17:28 ± 1.0 s, 40 s agoscout’s clock 00:17:30",
  );
});

test("of a run that is over the head says when it ended, and how long it took", async () => {
  expect(await times(runLine("finished"), {})).toBe("took83 ms | ended at UTC 00:16:40");
});

test("of a run that crashed or diverged nobody says that it has ended", async () => {
  expect(await times(runLine("crashed"), {})).toBe("mission timeT+00:00:00 | UTC 00:16:40");
});

test("in mission control nothing is said to run or not before it is known", async () => {
  const { watch } = watched(runLine("live"), { snapshot: null, link: "silent" });
  const place = shown(<Branches watch={watch} />, { watch });
  await settled();
  expect(place.textContent).toBe("Active states are not known yet.");
});

test("a replica that has diverged is named, with the way out and nothing to resume", async () => {
  const reason = "the robot has other events than this replica; move its folder away";
  const run = { ...runLine("crashed"), phase: "diverged", reason } as RunSummary;
  const { watch } = watched(run, { link: "over" });
  const place = shown(<Crash watch={watch} />, { watch });
  await settled();
  expect(place.querySelector("[role=alert] p")?.textContent).toBe(
    "The robot has other events than this replica; move its folder away.",
  );
  expect(place.querySelectorAll("button")).toHaveLength(0);
});
