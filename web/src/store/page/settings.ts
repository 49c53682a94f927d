/** Settings of this browser: defaults and storage. */

import { effect, type Signal, signal } from "@preact/signals-core";
import type { MachineFile } from "../../model/generated/protocol.ts";
import { isSame } from "../../model/json.ts";
import { kept, type LocalStore } from "../local_store.ts";
import type { Settings } from "./page.ts";
import { timeScale } from "./times.ts";

export const FIRST_SETTINGS: Settings = {
  theme: "system",
  wheel: "zoom",
  keymap: "rafcon",
  keys: {},
  recent: [],
  times: "mission",
  knowsTimeline: false,
};

export const THEMES: readonly { readonly value: Settings["theme"]; readonly title: string }[] = [
  { value: "system", title: "Same as system" },
  { value: "dark", title: "Dark" },
  { value: "light", title: "Light" },
];

/** Capacity of the recent folders. */
const RECENT_MAX = 20;
const KEY = "rafcon.settings";

/** Stored settings, with defaults for missing ones. */
function readSettings(localStore: LocalStore): Settings {
  return { ...FIRST_SETTINGS, ...kept<Partial<Settings>>(localStore, KEY) };
}

/** Settings, stored after each change. Only the values changed here are written, so that browser tabs keep each other's changes. */
export function followSettings(localStore: LocalStore): Signal<Settings> {
  let known = readSettings(localStore);
  /** Values that the browser refused to store. */
  let unkept: Partial<Settings> = {};
  const settings = signal(known);
  effect(() => {
    const wanted = settings.value;
    const changed = Object.entries(wanted).filter(
      ([name, value]) => known[name as keyof Settings] !== value,
    );
    if (changed.length === 0) return;
    const own: Partial<Settings> = { ...unkept, ...Object.fromEntries(changed) };
    known = { ...readSettings(localStore), ...own };
    localStore.put(KEY, known);
    unkept = isSame(readSettings(localStore), known) ? {} : own;
    settings.value = known;
  });
  effect(() => {
    timeScale.value = settings.value.times;
  });
  localStore.whenOther(KEY, () => {
    known = { ...readSettings(localStore), ...unkept };
    settings.value = known;
  });
  return settings;
}

/** The settings with the folder as the most recently opened one. */
export function withRecent(settings: Settings, file: MachineFile): Settings {
  const others = settings.recent.filter(
    ({ project, path }) => project !== file.project || path !== file.path,
  );
  return { ...settings, recent: [file, ...others].slice(0, RECENT_MAX) };
}
