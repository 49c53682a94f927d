/** Opens again what was open when the page ended, and from then on keeps what is open. */

import { effect, type Signal, signal } from "@preact/signals-core";
import type { MachineFile } from "../model/generated/protocol.ts";
import type { Runs } from "../store/history/run.ts";
import type { LocalStore } from "../store/local_store.ts";
import type { OpenTab, Page } from "../store/page/page.ts";
import { forgetGone } from "../store/page/selection.ts";
import { RefusalError, type Server } from "../store/page/server.ts";
import {
  type KeptTab,
  type KeptTabs,
  keepSession,
  readSession,
  restoreView,
  sessionOf,
} from "../store/page/session.ts";
import type { Clock } from "./clock.ts";

interface SessionPorts {
  readonly server: Server;
  readonly clock: Clock;
  /** Storage of this browser tab. */
  readonly own: LocalStore;
  /** Storage of the browser, for a new tab after a crash. */
  readonly shared: LocalStore;
  readonly tabs: Signal<readonly OpenTab[]>;
  readonly active: Signal<OpenTab | null>;
  /** `inBackground`: what is in front stays there. */
  readonly open: (file: MachineFile, inBackground: boolean) => Promise<OpenTab>;
  readonly showAsRan: (run: string, inBackground: boolean) => Promise<OpenTab>;
  readonly runs: Pick<Runs, "all" | "refresh" | "watch">;
  /** Calls when the page is about to end. */
  readonly leaving: (call: () => void) => void;
  readonly tell: Page["tell"];
}

/** Pause before views are stored, in ms. A moving camera is not stored. */
const KEPT_AFTER_MS = 500;

/** True while it is being restored. */
export function followSession(ports: SessionPorts): Signal<boolean> {
  const session = readSession(ports.own) ?? readSession(ports.shared);
  const isRestoring = signal(session !== null && session.tabs.length > 0);
  void restore(ports, session).finally(() => {
    isRestoring.value = false;
    keep(ports);
  });
  return isRestoring;
}

function keep({ clock, own, shared, tabs, active, leaving }: SessionPorts): void {
  let cancel = () => {};
  let session = sessionOf(tabs.peek(), active.peek());
  let opened: readonly OpenTab[] | null = null;
  const write = () => {
    cancel();
    for (const localStore of [own, shared]) keepSession(localStore, session);
  };
  effect(() => {
    session = sessionOf(tabs.value, active.value);
    cancel();
    if (tabs.value === opened) cancel = clock.after(KEPT_AFTER_MS, write);
    else write();
    opened = tabs.value;
  });
  leaving(write);
}

async function restore(ports: SessionPorts, session: KeptTabs | null): Promise<void> {
  if (!session) return;
  await untilUp(ports.server);
  if (session.tabs.some(({ run }) => run !== null)) await ports.runs.refresh();
  const places = new Map<OpenTab, number>();
  for (const [at, kept] of frontFirst(session)) {
    const tab = kept.file ? await openAgain(ports, kept.file) : await showAgain(ports, kept);
    if (!tab) continue;
    places.set(tab, at);
    ports.tabs.value = inPlace(ports.tabs.peek(), places);
    if (isThere(ports, kept)) tab.run.value ??= ports.runs.watch(kept.run);
    restoreView(tab.view, kept);
    forgetGone(tab.view, tab.session.machine);
    // With nothing in front before, this is it; with something there, the user has gone elsewhere meanwhile.
    ports.active.value ??= tab;
  }
}

/** The tabs with their places, the one that was in front first: it is shown while the others are still on their way. */
function frontFirst({ tabs, active }: KeptTabs): readonly (readonly [number, KeptTab])[] {
  const rank = (at: number) => (at === active ? -1 : at);
  return [...tabs.entries()].sort(([one], [other]) => rank(one) - rank(other));
}

/** The tabs in their earlier order, followed by tabs opened since. */
function inPlace(
  tabs: readonly OpenTab[],
  places: ReadonlyMap<OpenTab, number>,
): readonly OpenTab[] {
  const place = (tab: OpenTab) => places.get(tab) ?? Number.MAX_SAFE_INTEGER;
  return [...tabs].sort((one, other) => place(one) - place(other));
}

/** True if the shown run was not closed since. */
function isThere({ runs }: SessionPorts, kept: KeptTab): kept is KeptTab & { run: string } {
  return runs.all.peek().some(({ id }) => id === kept.run);
}

/** The machine as it ran, if it can still be had. */
async function showAgain(ports: SessionPorts, kept: KeptTab): Promise<OpenTab | null> {
  if (!isThere(ports, kept)) return null;
  try {
    return await ports.showAsRan(kept.run, true);
  } catch (error) {
    if (!(error instanceof RefusalError)) throw error;
    return null;
  }
}

async function openAgain(ports: SessionPorts, file: MachineFile): Promise<OpenTab | null> {
  try {
    return await ports.open(file, true);
  } catch (error) {
    if (!(error instanceof RefusalError)) throw error;
    const text = `${file.path} was open before but could not be reopened: ${error.message}`;
    ports.tell({ level: "warning", text });
    return null;
  }
}

/** Waits for the first connection. */
function untilUp(server: Server): Promise<void> {
  return new Promise((up) => {
    const stop = effect(() => {
      if (server.link.value.state !== "up") return;
      up();
      queueMicrotask(() => stop());
    });
  });
}
