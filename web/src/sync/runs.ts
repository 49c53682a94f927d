/** All runs of the server: which there are, how they begin, and each that is watched. */

import { effect, type Signal, signal } from "@preact/signals-core";
import type {
  RunSummary,
  ServerStatus,
  StartedRun,
  StartRun,
} from "../model/generated/protocol.ts";
import type { Runs, Start, Watch } from "../store/history/run.ts";
import { RefusalError } from "../store/page/server.ts";
import { requestUntilAnswered, StartRequests } from "./request_until_answered.ts";
import { RunWatch, type WatchPorts } from "./watch.ts";

const DEFAULTS: Omit<StartRun, "id" | "machine"> = {
  inputs: {},
  globals: {},
  start_from: null,
  afterwards: "go_on",
  keeping: "full",
  strict: false,
  hold: false,
  breakpoints: [],
  on_crash: null,
  size_max: null,
};

/** Retry interval of a failed list, in ms. */
const AGAIN_MS = 2_000;

/** Capacity of the watched runs besides the shown ones: those requested last. */
const WATCHED_MAX = 6;

/** The runs, followed from now on. */
export function followRuns(
  ports: WatchPorts,
  serverStatus: Signal<ServerStatus | null>,
  isShown: (run: string) => boolean = () => false,
): Runs {
  const { server, clock } = ports;
  const all = signal<readonly RunSummary[]>([]);
  /** Those that were asked for last at the end. */
  const watched = new Map<string, Watch>();
  const unwatchSome = () => {
    const unseen = [...watched.values()].filter(
      ({ id, sent }) => !isShown(id) && sent.peek().every(({ answer }) => answer !== null),
    );
    for (const watch of unseen.slice(0, -WATCHED_MAX)) {
      watch.close();
      watched.delete(watch.id);
    }
  };
  const removed = new Set<string>();
  const starts = new StartRequests(ports);
  /** Later messages are newer. */
  const take = (before: readonly RunSummary[], news: readonly RunSummary[]) => {
    const byId = new Map([...before, ...news].map((run) => [run.id, run]));
    for (const id of removed) byId.delete(id);
    all.value = [...byId.values()].sort((one, other) => other.started_ms - one.started_ms);
  };
  const refresh = async () => {
    try {
      const list = await server.request<readonly RunSummary[]>("GET", "/runs");
      // Messages during the request are not older than the list.
      take(list, serverStatus.peek()?.runs ?? []);
    } catch (error) {
      if (!(error instanceof RefusalError)) throw error;
      // After a break it is asked for anyway.
      clock.after(AGAIN_MS, () => {
        if (server.link.peek().state === "up") void refresh();
      });
    }
  };
  let connection: number | null = null;
  effect(() => {
    const link = server.link.value;
    // A connection that was only silent sends changes.
    if (link.state !== "up" || link.connection === connection) return;
    connection = link.connection;
    void refresh();
  });
  effect(() => take(all.peek(), serverStatus.value?.runs ?? []));
  return {
    all,
    refresh,
    watch: (id) => {
      const before = watched.get(id);
      const watch = before ?? new RunWatch(id, ports);
      watched.delete(id);
      watched.set(id, watch);
      if (!before) unwatchSome();
      return watch;
    },
    start: async (start: Start) => {
      const body: StartRun = { ...DEFAULTS, ...start, id: ports.newId() };
      const run = await requestUntilAnswered<RunSummary>(ports, "/runs", body);
      take(all.peek(), [run]);
      return run.id;
    },
    startAtRobot: async (robot: string, start: Start) => {
      const path = `/robots/${encodeURIComponent(robot)}/runs`;
      const { run } = await starts.start<StartedRun>(path, { ...DEFAULTS, ...start });
      return run;
    },
    get: (run, what) => server.request("GET", `/runs/${encodeURIComponent(run)}/${what}`),
    fetchValue: (run, value, isWanted) => {
      const path = `/runs/${encodeURIComponent(run)}/values/${value}/fetch`;
      return isWanted
        ? server.request("POST", path, { budget: null })
        : server.request("DELETE", path);
    },
    remove: async (id) => {
      await server.request("DELETE", `/runs/${encodeURIComponent(id)}`);
      watched.get(id)?.close();
      watched.delete(id);
      removed.add(id);
      take(all.peek(), []);
    },
  };
}
