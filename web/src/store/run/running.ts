/** The run of a tab, and whether it is active. */

import type { MachineFile, RunSummary, Session, Snapshot } from "../../model/generated/protocol.ts";
import { isSame } from "../../model/json.ts";
import { isLive } from "../../model/run_words.ts";
import type { Watch } from "../history/run.ts";
import type { OpenTab, Page } from "../page/page.ts";
import { truthAge } from "./age.ts";

/** Folder of a tab's machine. For a machine as it ran, the folder from which the run was started. */
export function fileOfTab(tab: OpenTab): MachineFile | null {
  const own = tab.session.status.value?.summary.file;
  return own ?? tab.run.value?.now.value?.run.machine ?? null;
}

/** Summary of a run; from the list until its status has arrived. */
export function summaryOf(page: Page, watch: Watch): RunSummary | null {
  return watch.now.value?.run ?? page.runs.all.value.find(({ id }) => id === watch.id) ?? null;
}

/** Run of the tab if it is active. */
export function liveRun(tab: OpenTab | null): Watch | null {
  const watch = tab?.run.value ?? null;
  const phase = watch?.now.value?.run.phase;
  return isLive(phase) ? watch : null;
}

export function snapshotOf(watch: Watch | null): Snapshot | null {
  return watch?.now.value?.snapshot ?? null;
}

/** Runs of a tab's machine, the newest first. */
export function runsOfTab(page: Page, tab: OpenTab): readonly RunSummary[] {
  const file = fileOfTab(tab);
  const shown = tab.run.value?.id;
  return page.runs.all.value.filter(
    ({ id, machine }) =>
      id === shown || (file !== null && machine !== null && isSame(machine, file)),
  );
}

/** Active runs of a tab's machine. A run that is started now runs beside them. */
export function runningBeside(page: Page, tab: OpenTab): readonly RunSummary[] {
  const shown = liveRun(tab)?.now.value?.run;
  const all = runsOfTab(page, tab);
  const listed = all.filter(({ phase }) => isLive(phase));
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

/** Session of the user of this page; null while it is unknown. */
export function sessionOfPage(page: Page): Session | null {
  const link = page.server.link.value;
  return link.state === "up" ? link.session : null;
}
