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

test("in the list of missions a run in progress lasts until now by the server's clock, one that is over as long as it took", async () => {
  vi.setSystemTime(STARTED_MS + 80_000);
  const runs = [runLine("live", "live-1"), runLine("finished", "over-1")];
  const place = shown(<NoRun />, { runs, ahead_ms: 5_000 });
  const pass = (ms: number) => act(() => vi.advanceTimersByTimeAsync(ms));
  const lengths = () =>
    [...place.querySelectorAll("small")].map((line) => line.textContent?.split(", ").at(-1));
  await pass(0);
  expect(lengths()).toEqual(["1:25", "83 ms"]);
  await pass(2_000);
  expect(lengths()).toEqual(["1:27", "83 ms"]);
});
