/** What was open and how it was looked at, so that a page that is loaded again, or a browser that crashed, comes back as it was. */

import type { ElementKey } from "../model/element.ts";
import type { MachineFile } from "../model/generated/protocol.ts";
import { isSame } from "../model/json.ts";
import type { OpenTab } from "./page.ts";
import { kept, type Shed } from "./shed.ts";
import { type Camera, FIRST_CAMERA, MODES, type RoomView, type ViewModes } from "./view.ts";

export interface KeptTab {
  readonly file: MachineFile;
  readonly camera: Camera;
  readonly selection: readonly ElementKey[];
  readonly modes: ViewModes;
  readonly contents: readonly (readonly [string, boolean])[];
}

export interface Session {
  readonly tabs: readonly KeptTab[];
  /** The folder of the machine in front. */
  readonly active: MachineFile | null;
}

const KEY = "rafcon.session";

/** What is open now. Machines without a folder are not kept. Reads signals: an effect is told when anything is different. */
export function sessionOf(tabs: readonly OpenTab[], active: OpenTab | null): Session {
  return { tabs: tabs.flatMap(keptTab), active: (active && fileOf(active)) ?? null };
}

export function keepSession(shed: Shed, session: Session): void {
  shed.put(KEY, session);
}

/** As it was kept; null if nothing was, or nothing that can be read. */
export function readSession(shed: Shed): Session | null {
  const session = kept<Partial<Session>>(shed, KEY);
  if (!Array.isArray(session?.tabs)) return null;
  const tabs = (session.tabs as Partial<KeptTab>[]).flatMap(readTab);
  return { tabs, active: session.active ?? null };
}

/** Looks at a machine as it was looked at before. */
export function restoreView(view: RoomView, { camera, selection, modes, contents }: KeptTab): void {
  view.camera.value = camera;
  view.selection.value = new Set(selection);
  view.modes.value = modes;
  view.contents.value = new Map(contents);
}

function fileOf({ room }: OpenTab): MachineFile | null {
  return room.status.value?.summary.file ?? null;
}

function keptTab(tab: OpenTab): readonly KeptTab[] {
  const file = fileOf(tab);
  if (!file) return [];
  const { camera, selection, modes, contents } = tab.view;
  return [
    {
      file,
      camera: camera.value,
      selection: [...selection.value],
      modes: modes.value,
      contents: [...contents.value],
    },
  ];
}

function readTab({ file, camera, selection, modes, contents }: Partial<KeptTab>): KeptTab[] {
  if (!file) return [];
  const isCamera =
    camera &&
    [camera.x, camera.y, camera.scale].every(Number.isFinite) &&
    !isSame(camera, FIRST_CAMERA);
  return [
    {
      file,
      camera: isCamera ? camera : FIRST_CAMERA,
      selection: selection ?? [],
      modes: { ...MODES, ...modes },
      contents: contents ?? [],
    },
  ];
}
