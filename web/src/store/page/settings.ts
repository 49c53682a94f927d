/** Settings of this browser: what they are at first, and how they are kept. */

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

/** So many folders are remembered. */
const RECENT_MAX = 20;
const KEY = "rafcon.settings";

/** As they were kept; what cannot be read is as at first. */
function readSettings(localStore: LocalStore): Settings {
  return { ...FIRST_SETTINGS, ...kept<Partial<Settings>>(localStore, KEY) };
}

/** The settings, kept from now on. Only what was changed here is written, so that tabs of a browser leave each other's changes. */
export function followSettings(localStore: LocalStore): Signal<Settings> {
  let known = readSettings(localStore);
  /** Values that the browser did not store. */
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

/** With the folder as the newest of those that were opened lately. */
export function withRecent(settings: Settings, file: MachineFile): Settings {
  const others = settings.recent.filter(
    ({ project, path }) => project !== file.project || path !== file.path,
  );
  return { ...settings, recent: [file, ...others].slice(0, RECENT_MAX) };
}
