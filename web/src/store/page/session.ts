/** Open tabs and their views, stored to restore the page after a reload or a crash of the browser. */

import type { ElementKey } from "../../model/element.ts";
import type { MachineFile } from "../../model/generated/protocol.ts";
import { isSame } from "../../model/json.ts";
import { kept, type LocalStore } from "../local_store.ts";
import type { OpenTab } from "./page.ts";
import { type Camera, FIRST_CAMERA, MODES, type SessionView, type ViewModes } from "./view.ts";

export interface KeptTab {
  /** Null for a machine as it ran. */
  readonly file: MachineFile | null;
  /** Id of the run on display. */
  readonly run: string | null;
  readonly camera: Camera;
  readonly selection: readonly ElementKey[];
  readonly modes: ViewModes;
  readonly contents: readonly (readonly [string, boolean])[];
}

export interface KeptTabs {
  readonly tabs: readonly KeptTab[];
  /** Index of the tab in front; null if none of them is. */
  readonly active: number | null;
}

const KEY = "rafcon.session";

/** Open tabs, except machines without a folder. Reads signals: an effect runs again after a change. */
export function sessionOf(tabs: readonly OpenTab[], active: OpenTab | null): KeptTabs {
  const all = tabs.flatMap((tab) => {
    const kept = keptTab(tab);
    return kept ? [{ tab, kept }] : [];
  });
  const at = all.findIndex(({ tab }) => tab === active);
  return { tabs: all.map(({ kept }) => kept), active: at < 0 ? null : at };
}

export function keepSession(localStore: LocalStore, session: KeptTabs): void {
  localStore.put(KEY, session);
}

/** Stored session; null if there is none, or if it cannot be read. */
export function readSession(localStore: LocalStore): KeptTabs | null {
  const session = kept<Partial<KeptTabs>>(localStore, KEY);
  if (!Array.isArray(session?.tabs)) return null;
  const tabs = (session.tabs as Partial<KeptTab>[]).flatMap(readTab);
  return { tabs, active: typeof session.active === "number" ? session.active : null };
}

/** Restores the view of a machine. */
export function restoreView(
  view: SessionView,
  { camera, selection, modes, contents }: KeptTab,
): void {
  view.camera.value = camera;
  view.selection.value = new Set(selection);
  view.modes.value = modes;
  view.contents.value = new Map(contents);
}

function fileOf({ session }: OpenTab): MachineFile | null {
  return session.status.value?.summary.file ?? null;
}

function keptTab(tab: OpenTab): KeptTab | null {
  const [file, run] = [fileOf(tab), tab.run.value?.id ?? null];
  if (!file && (tab.session.fixed === null || run === null)) return null;
  const { camera, selection, modes, contents } = tab.view;
  return {
    file,
    run,
    camera: camera.value,
    selection: [...selection.value],
    modes: modes.value,
    contents: [...contents.value],
  };
}

function readTab(tab: Partial<KeptTab>): KeptTab[] {
  const { file = null, run = null, camera, selection, modes, contents } = tab;
  if (!file && !run) return [];
  const isCamera =
    camera &&
    [camera.x, camera.y, camera.scale].every(Number.isFinite) &&
    !isSame(camera, FIRST_CAMERA);
  return [
    {
      file,
      run,
      camera: isCamera ? camera : FIRST_CAMERA,
      selection: selection ?? [],
      modes: { ...MODES, ...modes },
      contents: contents ?? [],
    },
  ];
}
