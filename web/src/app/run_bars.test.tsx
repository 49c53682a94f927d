// @vitest-environment happy-dom
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { RunNow, RunSummary } from "../model/generated/protocol.ts";
import { runLine, STARTED_MS, watched } from "../store/testing/watched.ts";
import { settled, unmount } from "../ui/testing/mounted.tsx";
import { Bars } from "./bars.tsx";
import { shown } from "./testing/shown.tsx";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  unmount();
  vi.useRealTimers();
});

/** The bars above the canvas beside such a run, which was heard a minute ago: each with its kind, up to its first colon or stop. */
async function bars(phase: "live" | "crashed", link: RunNow["link"]): Promise<readonly string[]> {
  vi.setSystemTime(STARTED_MS + 60_000);
  const { watch } = watched(runLine(phase), { link, runner_heard_ms: STARTED_MS });
  const { place } = shown((tab) => <Bars tab={tab} />, { watch });
  await settled();
  return [...place.querySelectorAll(".bar")].map((bar) => {
    const [text] = bar.querySelector(".bar-text")?.textContent?.split(/[:.]/) ?? [];
    return `${bar.classList[1]} ${bar.role} ${text}`;
  });
}

test("an engine that stands still is told as loudly as a crash, and one that is silent a little less", async () => {
  expect(await bars("live", "up")).toEqual([]);
  expect(await bars("live", "stuck")).toEqual(["bar-danger status The run is stuck"]);
  expect(await bars("crashed", "over")).toEqual(["bar-danger status The program of this run died"]);
  expect(await bars("live", "silent")).toEqual([
    "bar-warning status No answer from the run for 1 min 0 s",
  ]);
});

test("of an engine that stands still it is said for how long, and what to do", async () => {
  vi.setSystemTime(STARTED_MS + 60_000);
  const { watch } = watched(runLine("live"), { link: "stuck", runner_heard_ms: STARTED_MS });
  const { place } = shown((tab) => <Bars tab={tab} />, { watch });
  await settled();
  expect(place.querySelector(".bar-text")?.textContent).toBe(
    "The run is stuck: its program responds, but its engine has made no progress for 1 min 0 s. " +
      "Stop the run. If the engine does not respond, its program is ended and the run can be resumed.",
  );
});

test("a replica that has diverged is told as loudly, with the way out", async () => {
  const reason = "the robot has other events than this replica; move its folder away";
  const run = { ...runLine("crashed"), phase: "diverged", reason } as RunSummary;
  const { watch } = watched(run, { link: "over" });
  const { place } = shown((tab) => <Bars tab={tab} />, { watch });
  await settled();
  expect(place.querySelector(".bar-danger .bar-text")?.textContent).toBe(
    `This replica has diverged: ${reason}.`,
  );
});
