import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { RunNow } from "../../model/generated/protocol.ts";
import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import { sinceSnapshot } from "./since_snapshot.ts";

test("what a crash interrupted had gone on until then, and not only until the runner said something last", () => {
  const run = { phase: "crashed", length_ms: 7_000 };
  const now = { run, snapshot: { elapsed_ms: 1_000 }, snapshot_ms: 5 } as unknown as RunNow;
  const watch = { now: signal(now), playhead: signal(null) } as unknown as Watch;
  const page = { server: { pulse: signal(null) } } as unknown as Page;
  expect(sinceSnapshot(page, watch)).toBe(6_000);
});
