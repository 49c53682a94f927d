// @vitest-environment happy-dom
import { afterEach, expect, test, vi } from "vitest";
import type { RunSummary } from "../../model/generated/protocol.ts";
import { runLine, STARTED_MS } from "../../store/testing/watched.ts";
import { settled, unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { Runs } from "./runs.tsx";

afterEach(unmount);

test("the list of runs tells no length of a run in progress, as it would not grow", () => {
  const runs = [runLine("live", "live-1"), runLine("finished", "over-1")];
  const place = shown(<Runs />, { runs });
  const texts = [...place.querySelectorAll(".runs-when")].map((when) => when.textContent ?? "");
  expect(texts.map((text) => text.split(" · ").slice(1))).toEqual([[], ["83 ms"]]);
});

test("a run that is not heard goes on as of a time ago, and is drawn as assumed", async () => {
  vi.useFakeTimers();
  vi.setSystemTime(STARTED_MS + 245_000);
  const dark = { ...runLine("live", "dark-1"), robot: "scout", unheard_since_ms: STARTED_MS };
  const place = shown(<Runs />, { runs: [dark, runLine("live", "live-1")], ahead_ms: 5_000 });
  await settled();
  const rows = [...place.querySelectorAll(".runs-row")].map(
    (row) =>
      `${row.querySelector(".run-status")?.textContent}${row.matches(".is-old:has(.run-assumed)") ? " (assumed)" : ""}`,
  );
  expect(rows).toEqual(["runningas of 4 min 10 s ago (assumed)", "running"]);
  expect(place.querySelector(".runs-when")?.textContent).toMatch(/by scout’s clock$/);
  vi.useRealTimers();
});

test("a replica that has diverged says so in the list", () => {
  const run = { ...runLine("crashed"), phase: "diverged", reason: "other events" } as RunSummary;
  const place = shown(<Runs />, { runs: [run] });
  expect(place.querySelector(".run-word")?.textContent).toBe("diverged");
});
