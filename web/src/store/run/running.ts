/** Which run a tab shows, and whether that goes on. */

import type { MachineFile, RunSummary, Session, Snapshot } from "../../model/generated/protocol.ts";
import { isSame } from "../../model/json.ts";
import type { Watch } from "../history/run.ts";
import type { OpenTab, Page } from "../page/page.ts";
import { truthAge } from "./age.ts";

/** The folder of the machine of a tab; of a machine as it ran that which the run was started from. */
export function fileOfTab(tab: OpenTab): MachineFile | null {
  const own = tab.session.status.value?.summary.file;
  return own ?? tab.run.value?.now.value?.run.machine ?? null;
}

/** The line about the run; from the list until its own truth is here. */
export function summaryOf(page: Page, watch: Watch): RunSummary | null {
  return watch.now.value?.run ?? page.runs.all.value.find(({ id }) => id === watch.id) ?? null;
}

/** The run on the tab if it goes on. */
export function liveRun(tab: OpenTab | null): Watch | null {
  const watch = tab?.run.value ?? null;
  const phase = watch?.now.value?.run.phase;
  return phase === "live" || phase === "starting" ? watch : null;
}

export function snapshotOf(watch: Watch | null): Snapshot | null {
  return watch?.now.value?.snapshot ?? null;
}

/** Runs of the machine of a tab, the newest first. */
export function runsOfTab(page: Page, tab: OpenTab): readonly RunSummary[] {
  const file = fileOfTab(tab);
  const shown = tab.run.value?.id;
  return page.runs.all.value.filter(
    ({ id, machine }) =>
      id === shown || (file !== null && machine !== null && isSame(machine, file)),
  );
}

/** Runs of the machine of a tab that go on: what is started now runs beside them. */
export function runningBeside(page: Page, tab: OpenTab): readonly RunSummary[] {
  const shown = liveRun(tab)?.now.value?.run;
  const all = runsOfTab(page, tab);
  const listed = all.filter(({ phase }) => phase === "live" || phase === "starting");
  const isListed = shown === undefined || listed.some(({ id }) => id === shown.id);
  return isListed ? listed : [shown, ...listed];
}

/** True if every run of a tab may have ended since its last news. */
export function isUnconfirmed(page: Page, tab: OpenTab, now_ms: number): boolean {
  if (page.server.link.value.state !== "up") return true;
  const watch = liveRun(tab);
  return runningBeside(page, tab).every(({ id, unheard_since_ms }) =>
    watch?.id === id ? truthAge(page, watch, now_ms).isOld : unheard_since_ms !== undefined,
  );
}

/** Who works at this page; null while that is not known. */
export function sessionOfPage(page: Page): Session | null {
  const link = page.server.link.value;
  return link.state === "up" ? link.session : null;
}
