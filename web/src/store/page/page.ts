/** Everything that the page shows, as signals: who is there, what is open, which of it is in front. */

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
import type { Server } from "./server.ts";
import type { TimeScale } from "./times.ts";
import type { SessionView } from "./view.ts";

/** A machine that is open in this page, as a tab. */
export interface OpenTab {
  readonly session: MachineSession;
  readonly view: SessionView;
  /** The run that is shown on it; null if none is. */
  readonly run: Signal<Watch | null>;
}

/** The run in front: that of the machine in front. */
export function runOf(page: Page): Watch | null {
  return page.active.value?.run.value ?? null;
}

/** Something worth a glance. */
export interface Notice {
  readonly id: number;
  readonly level: "info" | "warning" | "error";
  readonly text: string;
  /** Where it belongs: a command by id, offered as a button. */
  readonly action?: {
    readonly title: string;
    readonly command: string;
    readonly argument?: unknown;
  };
  /** What it is about: clicks lead there. */
  readonly about?: { readonly machine: string; readonly element: ElementRef };
  /** It is shown where it happened, and only kept in the log. */
  readonly isQuiet?: boolean;
  /** It is news of what happens anyway: not kept in the log, and it takes the place of the one before on the same topic. */
  readonly passing?: { readonly topic: string; readonly machine: string };
  readonly at_ms: number;
  /** How often it was said: equal ones are one. */
  readonly count: number;
  /** True once the user has closed it or acted upon it. */
  readonly isClosed?: boolean;
}

/** Settings of this browser, kept in its storage. */
export interface Settings {
  readonly theme: "system" | "dark" | "light";
  /** What the wheel does without a key. */
  readonly wheel: "zoom" | "pan";
  /** `rafcon` or `classic`. */
  readonly keymap: string;
  /** Keys of single commands that the user chose, by command id. */
  readonly keys: Readonly<Record<string, readonly string[]>>;
  /** Folders opened lately, the newest first. */
  readonly recent: readonly MachineFile[];
  /** The scale on which times are shown. */
  readonly times: TimeScale;
  /** True once a start has shown the time line. The first start in a browser does. */
  readonly knowsTimeline: boolean;
}

export interface Page {
  readonly server: Server;
  readonly serverStatus: ReadonlySignal<ServerStatus | null>;
  readonly projects: ReadonlySignal<readonly Project[]>;
  readonly libraries: ReadonlySignal<readonly LibraryRoot[]>;
  readonly runs: Runs;
  readonly tabs: Signal<readonly OpenTab[]>;
  /** The machine in front. */
  readonly active: Signal<OpenTab | null>;
  /** Whether machines that were open before are still on their way. */
  readonly isRestoring: ReadonlySignal<boolean>;
  /** The run that was asked for and is on its way to its tab; null if none is. */
  readonly comingRun: ReadonlySignal<string | null>;
  readonly notices: Signal<readonly Notice[]>;
  /** Number of open notices that were dropped because there were too many. */
  readonly droppedNotices: Signal<number>;
  readonly settings: Signal<Settings>;
  /** Opens the machine in a folder, or brings it to the front. */
  readonly open: (file: MachineFile) => Promise<OpenTab>;
  /** Joins a machine that is open on the server. */
  readonly join: (machine: string) => Promise<OpenTab>;
  /** Shows a run: on the tab of its machine if that is open, else on one of its own with the machine as it ran. */
  readonly showRun: (run: string) => Promise<OpenTab>;
  /** Opens a tab with the machine as the run in it went by, beside the edited one. */
  readonly showAsRan: (run: string) => Promise<OpenTab>;
  /** Takes a tab away; the machine stays open on the server. */
  readonly leave: (tab: OpenTab) => void;
  /** Tells the user something. */
  readonly tell: (notice: Omit<Notice, "id" | "at_ms" | "count" | "isClosed">) => void;
}

export type { Revision };
