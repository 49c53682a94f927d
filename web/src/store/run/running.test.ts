import { signal } from "@preact/signals-core";
import { describe, expect, it } from "vitest";
import type { RunSummary } from "../../model/generated/protocol.ts";
import type { OpenTab, Page } from "../page/page.ts";
import { isUnconfirmed } from "./running.ts";

const FILE = { project: "p", path: "machine" };

function tabOf(unheard: readonly (number | undefined)[], link: "up" | "down"): [Page, OpenTab] {
  const runs = unheard.map((unheard_since_ms, at) => ({
    id: `run ${at}`,
    machine: FILE,
    phase: "live",
    ...(unheard_since_ms === undefined ? {} : { unheard_since_ms }),
  }));
  const page = {
    runs: { all: signal(runs as unknown as RunSummary[]) },
    server: { link: signal({ state: link }) },
  };
  const status = signal({ summary: { file: FILE } });
  const tab = { session: { status }, run: signal(null) };
  return [page as unknown as Page, tab as unknown as OpenTab];
}

const check = (...given: Parameters<typeof tabOf>) => isUnconfirmed(...tabOf(...given), 0);

describe("the runs of a tab", () => {
  it("are confirmed while one of them has news", () => {
    expect(check([undefined], "up")).toBe(false);
    expect(check([5_000, undefined], "up")).toBe(false);
  });

  it("may have ended without news of any, or without the server", () => {
    expect(check([5_000], "up")).toBe(true);
    expect(check([undefined], "down")).toBe(true);
  });
});
