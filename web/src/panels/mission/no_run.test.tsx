// @vitest-environment happy-dom
import { act } from "react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { runLine, STARTED_MS } from "../../store/testing/watched.ts";
import { unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { NoRun } from "./no_run.tsx";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  unmount();
  vi.useRealTimers();
});

test("in the list of missions a run in progress lasts until the server's last message, by its clock, one that is over as long as it took", async () => {
  vi.setSystemTime(STARTED_MS + 80_000);
  const runs = [runLine("live", "live-1"), runLine("finished", "over-1")];
  const place = shown(<NoRun />, { runs, ahead_ms: 5_000 });
  const pass = (ms: number) => act(() => vi.advanceTimersByTimeAsync(ms));
  const lengths = () =>
    [...place.querySelectorAll("small")].map((line) => line.textContent?.split(", ").at(-1));
  await pass(0);
  expect(lengths()).toEqual(["1:25", "83 ms"]);
  await pass(2_000);
  expect(lengths()).toEqual(["1:25", "83 ms"]);
});

test("in the list of missions a run that is not heard is assumed to go on", async () => {
  vi.setSystemTime(STARTED_MS + 80_000);
  const dark = {
    ...runLine("live", "dark-1"),
    robot: "scout",
    unheard_since_ms: STARTED_MS + 50_000,
  };
  const place = shown(<NoRun />, { runs: [dark] });
  await act(() => vi.advanceTimersByTimeAsync(0));
  const word = place.querySelector(".is-old .mission-assumed");
  expect(word?.textContent).toBe("runningas of 30 s ago");
  expect(place.querySelector("small + small, button > small")?.textContent).toMatch(/, 50 s$/);
});
