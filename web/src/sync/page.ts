/** Starts the page: connects, follows the server, and opens machines in tabs. */

import { effect, type Signal, signal, untracked } from "@preact/signals-core";
import type {
  LibraryRoot,
  MachineDocument,
  MachineFile,
  MachineStatus,
  MachineSummary,
  Project,
  ServerStatus,
} from "../model/generated/protocol.ts";
import { isSame } from "../model/json.ts";
import { drafts } from "../store/document/drafts.ts";
import { followDrafts } from "../store/document/follow_drafts.ts";
import { comparedRun } from "../store/history/compared_run.ts";
import type { Runs } from "../store/history/run.ts";
import { type LocalStore, localStoreOf, memoryStore, storageFault } from "../store/local_store.ts";
import { pageBase } from "../store/page/base.ts";
import { withStateNames } from "../store/page/names.ts";
import { putNotice } from "../store/page/notices.ts";
import type { Notice, OpenTab, Page, Settings } from "../store/page/page.ts";
import { RefusalError, type Server } from "../store/page/server.ts";
import { followSettings, withRecent } from "../store/page/settings.ts";
import { type Clock, WALL_CLOCK } from "./clock.ts";
import { connect } from "./connect.ts";
import type { Address } from "./http.ts";
import { newRequestId } from "./ids.ts";
import { LibraryCache } from "./library_cache.ts";
import { OpenMachineSession, type OpenMachineSessionPorts } from "./machine_session.ts";
import { tellPresence } from "./presence.ts";
import { gatherReturnNews } from "./return_news.ts";
import { RunMachineSession, runSessionId } from "./run_machine_session.ts";
import { followRuns } from "./runs.ts";
import { followSession } from "./session.ts";
import { newTabs } from "./tabs.ts";

interface PageOptions {
  /** Address of the server; by default the origin of the page. */
  readonly address?: Address;
  /** Another server than the one at the address. */
  readonly server?: Server;
  readonly clock?: Clock;
  /** Storage of settings and open machines; by default the browser's. */
  readonly stores?: { readonly own: LocalStore; readonly shared: LocalStore };
}

/** The page, at work from now on. */
export function startPage(options: PageOptions = {}): Page {
  const clock = options.clock ?? WALL_CLOCK;
  const server = options.server ?? connect(options.address ?? { url: pageBase() });
  const stores = options.stores ?? browserStores();
  const notices = signal<readonly Notice[]>([]);
  const droppedNotices = signal(0);
  let lastId = 0;
  const tell: Page["tell"] = (notice) => {
    lastId += 1;
    const text = withStateNames(machines.tabs.peek(), machines.active.peek(), notice.text);
    putNotice({ notices, droppedNotices }, { ...notice, text }, lastId, clock.now());
  };
  const serverStatus = signal<ServerStatus | null>(null);
  server.follow({
    topic: () => ({ topic: "server_status" }),
    frame: (frame) => {
      if (frame.frame === "server_status") serverStatus.value = frame.status;
    },
  });
  const libraryCache = new LibraryCache(server.request);
  const { projects, libraries } = followFiles(server, serverStatus, libraryCache);
  const settings = followSettings(stores.shared);
  const returnNews = gatherReturnNews(clock, tell);
  const ports = { server, libraryCache, clock, newId: newRequestId, tell, returnNews };
  const runs = followRuns(ports, serverStatus, (run) => shownRuns(machines.tabs.peek()).has(run));
  const machines = openMachines(ports, settings, runs);
  const isRestoring = followSession({ ...ports, ...stores, ...machines, runs, leaving });
  tellPresence(server, () => machines.active.value, clock);
  announceReconnects(server, clock, tell);
  tellStorageFault(tell);
  const known = { serverStatus, projects, libraries, robots: followRobots(server), isRestoring };
  return { server, ...known, runs, notices, droppedNotices, settings, tell, ...machines };
}

function browserStores(): { readonly own: LocalStore; readonly shared: LocalStore } {
  if (typeof window === "undefined") return { own: memoryStore(), shared: memoryStore() };
  return {
    own: localStoreOf(() => window.sessionStorage),
    shared: localStoreOf(() => window.localStorage),
  };
}

function leaving(call: () => void): void {
  if (typeof window !== "undefined") window.addEventListener("pagehide", call);
}

/** The runs that tabs show, and those that these are compared with. */
function shownRuns(tabs: readonly OpenTab[]): ReadonlySet<string | null> {
  const watches = tabs.flatMap(({ run }) => run.peek() ?? []);
  return new Set(watches.flatMap((watch) => [watch.id, comparedRun(watch).peek()]));
}

/** Projects and libraries, asked for again when files have changed. */
function followFiles(
  server: Server,
  serverStatus: Signal<ServerStatus | null>,
  libraryCache: LibraryCache,
) {
  const projects = signal<readonly Project[]>([]);
  const libraries = signal<readonly LibraryRoot[]>([]);
  let known: number | null = null;
  const ask = async () => {
    try {
      [projects.value, libraries.value] = await Promise.all([
        server.request<readonly Project[]>("GET", "/projects"),
        server.request<readonly LibraryRoot[]>("GET", "/libraries"),
      ]);
      await libraryCache.refresh();
    } catch (error) {
      if (!(error instanceof RefusalError)) throw error;
      known = null;
    }
  };
  effect(() => {
    // Failed requests are repeated after the next connection; loaded data only after changes.
    server.link.value;
    const revision = serverStatus.value?.files_revision ?? null;
    if (revision === null || revision === known) return;
    known = revision;
    void ask();
  });
  return { projects, libraries };
}

/** Names of the robots of a station, asked for with each connection. */
function followRobots(server: Server) {
  const robots = signal<readonly string[]>([]);
  let connection: number | null = null;
  const ask = async () => {
    try {
      robots.value = await server.request<readonly string[]>("GET", "/robots");
    } catch (error) {
      if (!(error instanceof RefusalError)) throw error;
      connection = null;
    }
  };
  effect(() => {
    const link = server.link.value;
    if (link.state !== "up" || link.connection === connection) return;
    connection = link.connection;
    void ask();
  });
  return robots;
}

/** Opens machines and runs in the tabs. */
function openMachines(ports: OpenMachineSessionPorts, settings: Signal<Settings>, runs: Runs) {
  const { request } = ports.server;
  const { tabs, active, front, enter, leave } = newTabs();

  const come = (summary: MachineSummary, inBackground = false): Promise<OpenTab> => {
    const { id, file } = summary;
    if (file) settings.value = withRecent(settings.peek(), file);
    const get = async () => {
      const path = `/machines/${encodeURIComponent(id)}/document`;
      const session = new OpenMachineSession(
        summary,
        await request<MachineDocument>("GET", path),
        ports,
      );
      followDrafts(session, drafts);
      return session;
    };
    return enter(id, get, null, inBackground);
  };

  const open = async (file: MachineFile, inBackground = false) =>
    come(await request<MachineSummary>("POST", "/machines/open", { file }), inBackground);

  const join = async (machine: string) => {
    const path = `/machines/${encodeURIComponent(machine)}`;
    return come((await request<MachineStatus>("GET", path)).summary);
  };

  const showAsRan = (id: string, inBackground = false) => {
    const watch = runs.watch(id);
    return enter(
      runSessionId(id),
      () => RunMachineSession.enter(watch, runs, ports),
      watch,
      inBackground,
    );
  };

  const toTab = async (id: string) => {
    const known = () => runs.all.peek().find((run) => run.id === id);
    // It may have begun elsewhere, a moment ago.
    if (!known()) await runs.refresh();
    const file = known()?.machine;
    const isOf = ({ session }: OpenTab) => {
      const own = session.status.peek()?.summary.file;
      return session.fixed === null && file != null && own != null && isSame(own, file);
    };
    const there = tabs.peek().find(isOf);
    if (!there) return showAsRan(id);
    there.run.value = runs.watch(id);
    return front(there);
  };

  const comingRun = signal<string | null>(null);
  const showRun = async (id: string) => {
    comingRun.value = id;
    try {
      return await toTab(id);
    } finally {
      if (comingRun.peek() === id) comingRun.value = null;
    }
  };

  return { tabs, active, comingRun, open, join, showRun, showAsRan, leave };
}

const STORAGE_FAULTS = {
  full: "The browser's storage for this page is full.",
  refused: "The browser does not let this page store anything.",
};

/** Says once what is lost when the browser does not keep it. */
function tellStorageFault(tell: Page["tell"]): void {
  effect(() => {
    const fault = storageFault.value;
    if (fault === null) return;
    const lost =
      "When you reload or close the page, you lose changed settings, scripts and descriptions that are not applied, watches, breakpoints for the next run, and acknowledgements. Apply your texts before you leave.";
    untracked(() => tell({ level: "warning", text: `${STORAGE_FAULTS[fault]} ${lost}` }));
  });
}

/** Reports a noticeable disconnection. */
const NOTICED_MS = 2_000;

/** Says when the connection is back after a break (to wait for a login is none), and when there is another server behind it. */
function announceReconnects(server: Server, clock: Clock, tell: Page["tell"]): void {
  let since: number | null = null;
  let version: string | null = null;
  effect(() => {
    const link = server.link.value;
    if (link.state === "down") since = version === null ? null : link.since_ms;
    if (link.state === "refused") since = null;
    if (link.state !== "up") return;
    const length_ms = since === null ? 0 : clock.now() - since;
    since = null;
    if (length_ms >= NOTICED_MS) {
      tell({ level: "info", text: `Reconnected after ${Math.round(length_ms / 1_000)} s` });
    }
    if (version !== null && version !== link.session.version) {
      const text = `The server now has version ${link.session.version}, but this page has version ${version}. Reload the page.`;
      tell({ level: "warning", text });
    }
    version ??= link.session.version;
  });
}
