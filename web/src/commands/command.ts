/** Commands: every action of the user as a named value. Menus, palette, shortcuts, buttons and tests call them by name. */

import type { CanvasControl } from "../canvas/control.ts";
import type { OpenTab, Page } from "../store/page.ts";

/** Where a command stands in the menus: `Edit/2` is the second block of Edit. Left out: in the palette only. */
export type MenuPlace =
  `${"File" | "Edit" | "Insert" | "Arrange" | "View" | "Run" | "Help"}/${number}`;

/** What the shell does for commands: it asks, shows and opens. */
export interface Shell {
  /** Asks for yes or no; the words of the buttons say what happens. */
  readonly confirm: (question: {
    title: string;
    text: string;
    yes: string;
    no?: string;
    danger?: boolean;
  }) => Promise<boolean>;
  /** Asks for one of several; null if the user wants none. */
  readonly choose: <T extends string>(question: {
    title: string;
    text: string;
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
  /** Opens a dialog by its name: `open`, `save-as`, `new`, `keys`, `settings`, `about`; its answer depends on it, null if it was closed. */
  readonly dialog: <T = unknown>(name: string, argument?: unknown) => Promise<T | null>;
  readonly openPalette: (query?: string) => void;
}

/** All that a command may look at and use. */
export interface Context {
  readonly page: Page;
  readonly tab: OpenTab | null;
  readonly canvas: CanvasControl | null;
  readonly shell: Shell;
}

export interface Command {
  /** `edit.delete`: words that stay. */
  readonly id: string;
  /** "Delete": what menus and palette say. */
  readonly title: string;
  /** One sentence more, for tooltips and the palette. */
  readonly detail?: string;
  /** Keys as `Ctrl+Shift+Z`, `F2`, `Delete`, `S`; single letters count on the canvas only. */
  readonly keys?: readonly string[];
  /** Keys of the map for those who come from the reference. */
  readonly classic?: readonly string[];
  readonly menu?: MenuPlace;
  /** Whether it can be done now. Left out: always. */
  readonly enabled?: (context: Context) => boolean;
  /** For switches: whether it is on. */
  readonly checked?: (context: Context) => boolean;
  readonly run: (context: Context, argument?: unknown) => void | Promise<void>;
}

/** All commands by id, in the order in which menus show them. */
export class Commands {
  readonly #all = new Map<string, Command>();

  /** Adds commands. An id that is there already is a mistake of the program. */
  add(commands: readonly Command[]): void {
    for (const command of commands) {
      if (this.#all.has(command.id)) throw new Error(`there are two commands ${command.id}`);
      this.#all.set(command.id, command);
    }
  }

  get(id: string): Command | undefined {
    return this.#all.get(id);
  }

  all(): readonly Command[] {
    return [...this.#all.values()];
  }

  /** Runs the command if it can be done now; false if there is none or it cannot. What it throws is told to the user. */
  run(id: string, context: Context, argument?: unknown): boolean {
    const command = this.#all.get(id);
    if (!command || command.enabled?.(context) === false) return false;
    const failed = (error: unknown) => {
      const text = error instanceof Error ? error.message : String(error);
      context.page.tell({ level: "error", text: `${command.title}: ${text}` });
    };
    try {
      Promise.resolve(command.run(context, argument)).catch(failed);
    } catch (error) {
      failed(error);
    }
    return true;
  }
}
