/** Ids of all commands with the types of their arguments. Buttons, notices and gestures name commands by these ids, so that the
 * compiler checks both. */

import type { ElementRef } from "../../model/element.ts";
import type {
  Breakpoint,
  ExportFormat,
  JsonValue,
  MachineFile,
  OnCrash,
  Question,
  StateKind,
} from "../../model/generated/protocol.ts";
import type { Point } from "../../model/geometry.ts";
import type { Start } from "../history/run.ts";
import type { OpenTab, Settings } from "./page.ts";
import type { FlowMode, HeatMode } from "./view.ts";

/** A clipboard, as events of copy, cut and paste have it. */
export type TextTransfer = Pick<DataTransfer, "getData" | "setData">;

/** A library to insert: its path, and the position of a drop. */
export interface InsertLibrary {
  /** A library root and the folders below it. */
  readonly path: string;
  readonly name: string;
  readonly version?: string | null;
  readonly container?: string;
  readonly at?: Point;
  /** The transition of the container into which it was dropped. */
  readonly transition?: number;
}

export interface Substitution {
  readonly path?: string;
  readonly library?: { readonly path: string; readonly name: string };
}

/** An outcome with which a state is to end. */
export interface Forced {
  readonly path: string;
  readonly outcome: number;
}

/** Decision about a state that a crash has interrupted. */
export interface Recovered {
  /** The state; null: all. */
  readonly path: string | null;
  readonly policy: "abort" | "restart";
}

/** Answer to a question of a state. */
export interface Answering {
  readonly question: Question;
  readonly value: JsonValue;
}

/** Commands without an argument. */
type PlainId =
  | `file.${"new" | "save" | "save-as" | "save-copy" | "save-state" | "save-all" | "overwrite"}`
  | `file.${"reload" | "compare" | "set-aside" | "open-library" | "show-library" | "close-all" | "log-out"}`
  | `edit.${"undo" | "redo" | "duplicate" | "select-all" | "select-start" | "select-none" | "rename" | "find"}`
  | `insert.${"execution" | "hierarchy" | "barrier" | "preemptive" | "fitting" | "connect"}`
  | `insert.${"outcome" | "input" | "output" | "scoped-variable"}`
  | `insert.transition-${"from-sibling" | "to-sibling" | "to-parent"}`
  | `arrange.${"group" | "ungroup" | "start-state" | "layout-level" | "layout-all" | "keep-layout"}`
  | `arrange.${"fit-content" | "clear-waypoints" | "background" | "show-content"}`
  | `arrange.align-${"left" | "centre" | "right" | "top" | "middle" | "bottom"}`
  | `arrange.distribute-${"horizontal" | "vertical"}`
  | `view.${"fit" | "zoom-selection" | "zoom-in" | "zoom-out" | "library-content" | "full-screen"}`
  | `view.${"transitions" | "names" | "values" | "aborted" | "grid"}`
  | `view.${"left" | "bottom" | "right" | "focus" | "save-layout"}`
  | `run.${"start-with" | "start-held" | "start-again" | "start-at-robot" | "pause" | "resume"}`
  | `run.${"toggle-pause" | "kill" | "reload" | "step-mode" | "clear-breakpoints" | "leave" | "follow" | "live"}`
  | `run.${"event-before" | "event-after" | "entry-before" | "entry-after" | "first-event"}`
  | `control.${"request" | "withdraw" | "accept" | "decline" | "release" | "take-over" | "override"}`
  | `help.${"commands" | "keys" | "settings" | "about"}`
  | "mission.open"
  | "planner.show";

/** Arguments by id. `undefined`: the command also runs without one. */
export interface CommandArguments extends Readonly<Record<PlainId, undefined>> {
  readonly "file.open": MachineFile | undefined;
  readonly "file.recent": MachineFile;
  readonly "file.close": OpenTab | undefined;
  readonly "file.close-others": OpenTab | undefined;
  readonly "edit.cut": TextTransfer | null | undefined;
  readonly "edit.copy": TextTransfer | null | undefined;
  readonly "edit.paste": TextTransfer | null | undefined;
  readonly "edit.delete": readonly ElementRef[] | undefined;
  readonly "insert.library": InsertLibrary | undefined;
  readonly "insert.template": InsertLibrary | undefined;
  readonly "insert.into-transition": StateKind;
  readonly "arrange.substitute": Substitution | undefined;
  /** True to keep the name of the state. */
  readonly "arrange.substitute-template": boolean | undefined;
  readonly "arrange.change-kind": StateKind;
  readonly "view.data-flows": FlowMode | undefined;
  readonly "view.heat": HeatMode | undefined;
  /** Id of a panel. */
  readonly "view.panel": string;
  /** Name of a layout. */
  readonly "view.layout": string;
  readonly "view.remove-layout": string;
  readonly "view.theme": Settings["theme"];
  readonly "view.times": Settings["times"];
  readonly "run.start": Partial<Start> | undefined;
  /** `sure`: the user has confirmed it already. */
  readonly "run.stop": "sure" | undefined;
  /** Path of a state; the selected one by default. */
  readonly "run.start-here": string | undefined;
  readonly "run.stop-here": string | undefined;
  readonly "run.selected": string | undefined;
  readonly "run.only-selected": string | undefined;
  readonly "run.breakpoint": string | undefined;
  readonly "run.preempt": string | undefined;
  /** An existing breakpoint, or the path of a state for a new one. */
  readonly "run.edit-breakpoint": Breakpoint | string | undefined;
  readonly "run.force-outcome": Forced;
  /** Branch; all by default. */
  readonly "run.into": string | undefined;
  readonly "run.over": string | undefined;
  readonly "run.out": string | undefined;
  readonly "run.back": string | undefined;
  readonly "run.resume-crashed": OnCrash | undefined;
  readonly "run.recover": Recovered;
  /** Id of a run; the shown one by default. */
  readonly "run.show": string;
  readonly "run.show-as-ran": string | undefined;
  readonly "run.delete": string | undefined;
  /** Id of the other run. */
  readonly "run.compare": string | undefined;
  /** Sequence number of an entry; the one that follows the shown moment by default. */
  readonly "run.start-from-history": number | undefined;
  readonly "run.export": { readonly run: string; readonly format: ExportFormat };
  /** Without one, mission control shows the question. */
  readonly "run.answer": Answering | undefined;
  /** Id of a run. */
  readonly "mission.show": string | undefined;
  /** Sequence number of a failure; all by default. */
  readonly "mission.acknowledge": number | undefined;
  /** Name of a user. */
  readonly "control.hand-over": string | undefined;
  /** Query. */
  readonly "help.palette": string | undefined;
}

export type CommandId = keyof CommandArguments;

/** Commands that run without an argument. */
export type FreeCommandId = {
  [Id in CommandId]: undefined extends CommandArguments[Id] ? Id : never;
}[CommandId];

/** Parameters after the id: the argument, which may be left out if the command runs without one. */
export type ArgumentOf<Id extends CommandId> = undefined extends CommandArguments[Id]
  ? [argument?: CommandArguments[Id]]
  : [argument: CommandArguments[Id]];

/** A command with its argument, as data. */
export type CommandCall = {
  readonly [Id in CommandId]: undefined extends CommandArguments[Id]
    ? { readonly command: Id; readonly argument?: CommandArguments[Id] }
    : { readonly command: Id; readonly argument: CommandArguments[Id] };
}[CommandId];
