/** Everything that the page shows, as signals: sessions, open machines, and the one in front. */

import type { ReadonlySignal, Signal } from "@preact/signals-core";
import type { ElementRef } from "../../model/element.ts";
import type {
  LibraryRoot,
  MachineFile,
  Project,
  Revision,
  ServerStatus,
} from "../../model/generated/protocol.ts";
import type { MachineSession } from "../document/machine_session.ts";
import type { Runs, Watch } from "../history/run.ts";
import type { CommandCall } from "./command_arguments.ts";
import type { Server } from "./server.ts";
import type { TimeScale } from "./times.ts";
import type { SessionView } from "./view.ts";

/** An open machine of this page, as a tab. */
export interface OpenTab {
  readonly session: MachineSession;
  readonly view: SessionView;
  /** Run on display; null if none. */
  readonly run: Signal<Watch | null>;
}

/** Run of the machine in front. */
export function runOf(page: Page): Watch | null {
  return page.active.value?.run.value ?? null;
}

/** A message to the user. */
export interface Notice {
  readonly id: number;
  readonly level: "info" | "warning" | "error";
  readonly text: string;
  /** Command to offer as a button, by id. */
  readonly action?: CommandCall & { readonly title: string };
  /** Subject of the notice: a click reveals it. */
  readonly about?: { readonly machine: string; readonly element: ElementRef };
  /** True if the notice is shown in place, and otherwise only in the log. */
  readonly isQuiet?: boolean;
  /** Set for news of a run. It is not in the log, and replaces the previous notice on its topic. */
  readonly passing?: { readonly topic: string; readonly machine: string };
  readonly at_ms: number;
  /** Number of equal notices, including this one. */
  readonly count: number;
  /** True once the user has closed it or acted on it. */
  readonly isClosed?: boolean;
}

/** Settings of this browser, stored in it. */
export interface Settings {
  readonly theme: "system" | "dark" | "light";
  /** Effect of the wheel without a modifier key. */
  readonly wheel: "zoom" | "pan";
  /** `rafcon` or `classic`. */
  readonly keymap: string;
  /** Keys that the user assigned to commands, by command id. */
  readonly keys: Readonly<Record<string, readonly string[]>>;
  /** Recently opened folders, the newest first. */
  readonly recent: readonly MachineFile[];
  /** Scale of displayed times. */
  readonly times: TimeScale;
  /** True once a start has shown the time line. The first start in a browser does. */
  readonly knowsTimeline: boolean;
}

export interface Page {
  readonly server: Server;
  readonly serverStatus: ReadonlySignal<ServerStatus | null>;
  readonly projects: ReadonlySignal<readonly Project[]>;
  readonly libraries: ReadonlySignal<readonly LibraryRoot[]>;
  /** Names of the robots that the server receives as their station. */
  readonly robots: ReadonlySignal<readonly string[]>;
  readonly runs: Runs;
  readonly tabs: Signal<readonly OpenTab[]>;
  /** The machine in front. */
  readonly active: Signal<OpenTab | null>;
  /** True while the machines of the last session are being opened. */
  readonly isRestoring: ReadonlySignal<boolean>;
  /** Id of the requested run until its tab shows it; null if none. */
  readonly comingRun: ReadonlySignal<string | null>;
  readonly notices: Signal<readonly Notice[]>;
  /** Number of open notices dropped because of the limit. */
  readonly droppedNotices: Signal<number>;
  readonly settings: Signal<Settings>;
  /** Opens the machine in a folder, or brings it to the front. */
  readonly open: (file: MachineFile) => Promise<OpenTab>;
  /** Shows a machine that is already open on the server. */
  readonly join: (machine: string) => Promise<OpenTab>;
  /** Shows a run: on the tab of its machine if that is open, otherwise on a new tab with the machine as it ran. */
  readonly showRun: (run: string) => Promise<OpenTab>;
  /** Opens a tab with the machine as it ran, beside the edited machine. */
  readonly showAsRan: (run: string) => Promise<OpenTab>;
  /** Closes a tab. The machine stays open on the server. */
  readonly leave: (tab: OpenTab) => void;
  /** Shows a notice to the user. */
  readonly tell: (notice: Omit<Notice, "id" | "at_ms" | "count" | "isClosed">) => void;
}

export type { Revision };
