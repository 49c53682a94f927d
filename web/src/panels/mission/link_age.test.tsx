// @vitest-environment happy-dom
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { LinkHealth, RunNow } from "../../model/generated/protocol.ts";
import { runLine, STARTED_MS, watched } from "../../store/testing/watched.ts";
import { settled, unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { LinkAge } from "./link_age.tsx";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  unmount();
  vi.useRealTimers();
});

/** What mission control says about the link, a minute after the run was heard; an alarm is marked. */
async function shownFor(link: RunNow["link"], robot?: LinkHealth): Promise<string> {
  vi.setSystemTime(STARTED_MS + 60_000);
  const { watch } = watched(runLine("live"), {
    link,
    runner_heard_ms: STARTED_MS,
    ...(robot ? { robot } : {}),
  });
  const place = shown(<LinkAge watch={watch} />, { watch });
  await settled();
  const isAlarm = place.querySelector(".mission-band-old[role=alert]") !== null;
  return `${isAlarm ? "! " : ""}${place.textContent}`;
}

test("mission control gives the alarm when the robot is not heard, or the engine stands still", async () => {
  expect(await shownFor("up")).toBe("Live: server and robot respond (3 ms)");
  expect(await shownFor("stuck")).toBe("! The engine of the run has made no progress for 1:00.");
  expect(await shownFor("silent")).toBe(
    "! The server gets no answer from the robot: what you see is 1:00 old.",
  );
});

test("of a robot that is far away it is said how old the newest is", async () => {
  const robot: LinkHealth = {
    robot: "scout",
    is_heard: true,
    heard_ms: STARTED_MS + 60_000,
    expected_every_ms: 500,
    reached_ms: STARTED_MS + 56_000,
    round_trip_ms: 4_000,
    lifetime_ms: 22_000,
    command_bytes_per_s: 2_000,
    down_bytes_per_s: 900,
    up_bytes_per_s: 90,
    missing: 0,
    commands: [],
    clock: null,
  };
  expect(await shownFor("up", robot)).toBe("Live: server and robot respond (2.0 s ago)");
  const silent = { ...robot, heard_ms: STARTED_MS + 53_000 };
  expect(await shownFor("up", silent)).toBe("Nothing received from the robot for 7 s");
  const mute = { ...robot, reached_ms: null, round_trip_ms: null };
  expect(await shownFor("up", mute)).toBe("Live: server and robot respond (delay unknown)");
});
