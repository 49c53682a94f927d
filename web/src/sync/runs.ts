/** All runs of the house: which there are, how they begin, and each that is watched. */

import { effect, type Signal, signal } from "@preact/signals-core";
import type { HouseStatus, RunSummary, StartRun } from "../model/generated/protocol.ts";
import type { Runs, Start, Watch } from "../store/run.ts";
import { RefusalError } from "../store/server.ts";
import { saidAgain } from "./said_again.ts";
import { RunWatch, type WatchPorts } from "./watch.ts";

const DEFAULTS: Omit<StartRun, "id" | "machine"> = {
  inputs: {},
  start_from: null,
  keeping: "full",
  strict: false,
  hold: false,
  breakpoints: [],
  on_crash: null,
  size_max: null,
};

/** The runs, followed from now on. */
export function followRuns(ports: WatchPorts, house: Signal<HouseStatus | null>): Runs {
  const { server } = ports;
  const all = signal<readonly RunSummary[]>([]);
  const watched = new Map<string, Watch>();
  const take = (news: readonly RunSummary[]) => {
    const byId = new Map(all.peek().map((run) => [run.id, run]));
    for (const run of news) byId.set(run.id, run);
    all.value = [...byId.values()].sort((one, other) => other.started_ms - one.started_ms);
  };
  const refresh = async () => {
    try {
      all.value = await server.request<readonly RunSummary[]>("GET", "/runs");
    } catch (error) {
      if (!(error instanceof RefusalError)) throw error;
    }
  };
  effect(() => {
    if (server.link.value.state === "up") void refresh();
  });
  effect(() => take(house.value?.runs ?? []));
  return {
    all,
    refresh,
    watch: (id) => {
      const before = watched.get(id);
      if (before) return before;
      const watch = new RunWatch(id, ports);
      watched.set(id, watch);
      return watch;
    },
    start: async (start: Start) => {
      const body: StartRun = { ...DEFAULTS, ...start, id: ports.newId() };
      const run = await saidAgain<RunSummary>(ports, "/runs", body);
      take([run]);
      return run.id;
    },
    get: (run, what) => server.request("GET", `/runs/${encodeURIComponent(run)}/${what}`),
    remove: async (id) => {
      await server.request("DELETE", `/runs/${encodeURIComponent(id)}`);
      watched.get(id)?.close();
      watched.delete(id);
      all.value = all.peek().filter((run) => run.id !== id);
    },
  };
}
