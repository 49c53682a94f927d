/** Settings of this browser: what they are at first, and how they are kept. */

import type { MachineFile } from "../model/generated/protocol.ts";
import type { Settings } from "./page.ts";
import { kept, type Shed } from "./shed.ts";

export const FIRST_SETTINGS: Settings = {
  theme: "system",
  wheel: "zoom",
  keymap: "rafcon",
  keys: {},
  libraryLevels: 1,
  recent: [],
};

/** So many folders are remembered. */
const RECENT_MAX = 20;
const KEY = "rafcon.settings";

/** As they were kept; what cannot be read is as at first. */
export function readSettings(shed: Shed): Settings {
  return { ...FIRST_SETTINGS, ...kept<Partial<Settings>>(shed, KEY) };
}

export function keepSettings(shed: Shed, settings: Settings): void {
  shed.put(KEY, settings);
}

/** With the folder as the newest of those that were opened lately. */
export function withRecent(settings: Settings, file: MachineFile): Settings {
  const others = settings.recent.filter(
    ({ project, path }) => project !== file.project || path !== file.path,
  );
  return { ...settings, recent: [file, ...others].slice(0, RECENT_MAX) };
}
