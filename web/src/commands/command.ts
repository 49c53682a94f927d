/** Commands: every action of the user as a named value. Menus, palette, shortcuts, buttons and tests call them by name. */

import type { CanvasControl } from "../canvas/control.ts";
import type { Breakpoint, MachineFile, OnCrash } from "../model/generated/protocol.ts";
import type { Start, Watch } from "../store/history/run.ts";
import type {
  ArgumentOf,
  CommandArguments,
  CommandCall,
  CommandId,
} from "../store/page/command_arguments.ts";
import type { OpenTab, Page } from "../store/page/page.ts";

/** The menus of the bar, in order. */
export const MENUS = ["File", "Edit", "Insert", "Arrange", "View", "Run", "Help"] as const;

/** Position of a command in the menus: `Edit/2` is the second block of Edit, `Arrange/1/Align` the menu Align in the first of
 * Arrange. Left out: in the palette only. */
export type MenuPlace =
  | `${(typeof MENUS)[number]}/${number}`
  | `${(typeof MENUS)[number]}/${number}/${string}`;

/** One of several things that a command can be done with. */
export interface CommandChoice<Argument = unknown> {
  readonly title: string;
  readonly detail?: string;
  readonly argument: Argument;
  readonly checked?: boolean;
  readonly disabled?: boolean;
}

/** Requests and results of dialogs. */
export interface Dialogs {
  /** A machine to open. */
  readonly open: { readonly asks: undefined; readonly answer: MachineFile };
  /** A folder for a machine that is not there yet; `name` is what the folder might be called. */
  readonly "save-as": {
    readonly asks: { readonly title: string; readonly name: string; readonly yes: string };
    readonly answer: MachineFile;
  };
  readonly new: {
    readonly asks: undefined;
    readonly answer: { readonly file: MachineFile; readonly name: string };
  };
  /** A library to be put in the place of something. */
  readonly library: {
    readonly asks: { readonly title: string; readonly yes: string };
    readonly answer: { readonly path: string; readonly name: string };
  };
  readonly colour: { readonly asks: Rgb | null; readonly answer: { readonly rgb: Rgb | null } };
  /** Start parameters of a run. */
  readonly "start-run": { readonly asks: OpenTab; readonly answer: Partial<Start> };
  /** A machine of a robot of this station. */
  readonly "start-at-robot": {
    readonly asks: undefined;
    readonly answer: { readonly robot: string; readonly machine: MachineFile };
  };
  /** Fate of the scripts that a crash has interrupted. */
  readonly "resume-crashed": { readonly asks: Watch; readonly answer: OnCrash };
  /** Edits of the machine of a tab that were set aside. */
  readonly "set-aside": { readonly asks: OpenTab; readonly answer: undefined };
  readonly breakpoint: { readonly asks: Breakpoint; readonly answer: Breakpoint };
  readonly keys: { readonly asks: undefined; readonly answer: undefined };
  readonly settings: { readonly asks: undefined; readonly answer: undefined };
  readonly about: { readonly asks: undefined; readonly answer: undefined };
}

/** A colour as files keep it: red, green, blue from 0 to 1. */
export type Rgb = readonly [number, number, number];

/** Arrangement of the panels. */
export interface Layouts {
  /** Those that ship, then those that the user saved. */
  readonly names: () => readonly string[];
  readonly own: () => readonly string[];
  readonly apply: (name: string) => void;
  readonly save: (name: string) => void;
  readonly remove: (name: string) => void;
  readonly isShown: (side: PanelSide) => boolean;
  readonly toggle: (side: PanelSide) => void;
  /** All panels away but the canvas, or back. */
  readonly toggleFocus: () => void;
  readonly panels: () => readonly { readonly id: string; readonly title: string }[];
}

export type PanelSide = "left" | "right" | "bottom";

/** Services of the shell for commands: questions, notices and dialogs. */
export interface Shell {
  /** Asks a question with two buttons that name their actions. */
  readonly confirm: (question: {
    title: string;
    text: string;
    yes: string;
    no?: string;
    danger?: boolean;
  }) => Promise<boolean>;
  /** Asks for one of several choices; null if the user cancels. */
  readonly choose: <T extends string>(question: {
    title: string;
    text: string;
    list?: readonly string[];
    safe: NoInfer<T> | null;
    choices: readonly { value: T; title: string; detail?: string }[];
  }) => Promise<T | null>;
  /** Asks for a text; null if the user gives none. */
  readonly prompt: (question: {
    title: string;
    label: string;
    initial?: string;
    check?: (text: string) => string | null;
  }) => Promise<string | null>;
  /** Shows a panel and brings it to the front: `inspector`, `libraries`, … */
  readonly showPanel: (panel: string) => void;
  /** Opens a dialog; null if it was closed without an answer. */
  readonly dialog: <N extends keyof Dialogs>(
    name: N,
    argument: Dialogs[N]["asks"],
  ) => Promise<Dialogs[N]["answer"] | null>;
  readonly openPalette: (query?: string) => void;
  /** Fits the machine into the canvas once the panels are in place. */
  readonly overview: () => void;
  readonly layouts: Layouts;
}

/** Context of a command. */
export interface CommandContext {
  readonly page: Page;
  readonly tab: OpenTab | null;
  readonly canvas: CanvasControl | null;
  readonly shell: Shell;
}

/** A command, whatever its argument. */
export type UserCommand = { readonly [Id in CommandId]: CommandOf<Id> }[CommandId];

export interface CommandOf<Id extends CommandId> {
  /** `edit.delete`: words that stay. */
  readonly id: Id;
  /** Label in menus and palette, such as "Delete". */
  readonly title: string;
  /** One sentence more, for tooltips and the palette. */
  readonly detail?: string;
  /** Keys as `Ctrl+Shift+Z`, `F2`, `Delete`, `S`; single letters count on the canvas only. */
  readonly keys?: readonly string[];
  /** Keys of the map for those who come from the reference. */
  readonly classic?: readonly string[];
  readonly menu?: MenuPlace;
  /** True if it edits the machine, which needs the right to do so. */
  readonly edits?: boolean;
  /** True if a key that is held runs it once only. */
  readonly once?: boolean;
  /** True if the command is available; always by default. */
  readonly enabled?: (context: CommandContext) => boolean;
  /** Instruction while `enabled` is false, such as "select a state first". */
  readonly needs?: string;
  /** Reason and remedy while the command is unavailable; null if it is available. For commands whose reasons are not obvious. */
  readonly refusal?: (
    context: CommandContext,
    argument: CommandArguments[Id] | undefined,
  ) => string | null;
  /** For switches: whether it is on. */
  readonly checked?: (context: CommandContext) => boolean;
  /** Choices of the argument: a submenu whose entries run the command. */
  readonly choices?: (context: CommandContext) => readonly CommandChoice<CommandArguments[Id]>[];
  /** A key runs it without an argument, whatever its type. */
  readonly run: (context: CommandContext, argument: CommandArguments[Id] | undefined) => unknown;
}

/** Reason why the command is unavailable without an argument, empty if it is obvious; null if it is available. */
export function refusalOf(command: UserCommand, context: CommandContext): string | null {
  if (command.enabled?.(context) === false) return "";
  return command.refusal?.(context, undefined) ?? null;
}

/** All commands by id, in the order in which menus show them. */
export class Commands {
  readonly #all = new Map<string, UserCommand>();

  /** Reason why a command cannot be run; null if it can. Unknown commands are refused without a reason. */
  refusalOf(id: CommandId, context: CommandContext): string | null {
    const command = this.#all.get(id);
    return command ? refusalOf(command, context) : "";
  }

  /** Registers commands. A repeated id is a programming error. */
  add(commands: readonly UserCommand[]): void {
    for (const command of commands) {
      if (this.#all.has(command.id)) throw new Error(`there are two commands ${command.id}`);
      this.#all.set(command.id, command);
    }
  }

  get(id: CommandId): UserCommand | undefined {
    return this.#all.get(id);
  }

  /** The command of an id from outside, such as from settings. */
  find(id: string): UserCommand | undefined {
    return this.#all.get(id);
  }

  all(): readonly UserCommand[] {
    return [...this.#all.values()];
  }

  /** Runs an available command; false if it is unknown or unavailable. Errors are reported to the user. */
  run<Id extends CommandId>(
    id: Id,
    context: CommandContext,
    ...[argument]: ArgumentOf<Id>
  ): boolean {
    const command = this.#all.get(id);
    return command !== undefined && this.#run(command, context, argument);
  }

  /** Runs a command that was found by its properties, with one of its choices. */
  choose(command: UserCommand, context: CommandContext, choice?: CommandChoice): boolean {
    return this.#run(command, context, choice?.argument);
  }

  /** Runs a command that was stored as data. */
  call({ command: id, argument }: CommandCall, context: CommandContext): boolean {
    const command = this.#all.get(id);
    return command !== undefined && this.#run(command, context, argument);
  }

  /** The callers have checked that the argument belongs to the command. */
  #run(command: UserCommand, context: CommandContext, argument: unknown): boolean {
    context.canvas?.flush();
    if (command.enabled?.(context) === false) return false;
    if ((command.refusal?.(context, argument as undefined) ?? null) !== null) return false;
    const failed = (error: unknown) => {
      const text = error instanceof Error ? error.message : String(error);
      context.page.tell({ level: "error", text: `${command.title}: ${text}` });
    };
    try {
      Promise.resolve(command.run(context, argument as undefined)).catch(failed);
    } catch (error) {
      failed(error);
    }
    return true;
  }
}
