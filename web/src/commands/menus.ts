/** Menus as lists of commands: the menu bar by the positions of commands, context menus by the clicked element. */

import type { ElementRef } from "../model/element.ts";
import type { CommandId } from "../store/page/command_arguments.ts";
import type { CommandContext, Commands, UserCommand } from "./command.ts";
import { MENUS, refusalOf } from "./command.ts";
import { shownKey } from "./keys.ts";

/** One entry, ready to be shown. */
export type CommandMenuEntry =
  | "separator"
  | {
      readonly id: string;
      readonly title: string;
      readonly keys?: string;
      readonly detail?: string;
      readonly checked?: boolean;
      readonly disabled?: boolean;
      readonly items?: readonly CommandMenuEntry[];
      readonly run?: () => void;
    };

/** Input of menus. */
interface MenuSource {
  readonly commands: Commands;
  readonly context: CommandContext;
  /** The keys of a command, as set. */
  readonly keys: (id: string) => readonly string[];
}

/** Titles of the menus of the bar that have entries. */
export function menuTitles(commands: Commands): readonly (typeof MENUS)[number][] {
  const used = new Set(commands.all().map(({ menu }) => menu?.split("/")[0]));
  return MENUS.filter((title) => used.has(title));
}

/** The entries of a menu of the bar. */
export function barMenu(source: MenuSource, title: string): readonly CommandMenuEntry[] {
  const blocks = new Map<string, CommandMenuEntry[]>();
  const inner = new Map<string, CommandMenuEntry[]>();
  for (const command of source.commands.all()) {
    const [menu, block = "", within] = command.menu?.split("/") ?? [];
    if (menu !== title) continue;
    const entries = blocks.get(block) ?? [];
    blocks.set(block, entries);
    if (within === undefined) {
      entries.push(entryOf(source, command));
      continue;
    }
    const known = inner.get(within);
    if (known) known.push(entryOf(source, command));
    else {
      const items = [entryOf(source, command)];
      inner.set(within, items);
      entries.push({ id: `${title}/${within}`, title: within, items });
    }
  }
  const ordered = [...blocks].sort(([one], [other]) => Number(one) - Number(other));
  return joined(ordered.map(([, entries]) => entries));
}

function joined(blocks: readonly (readonly CommandMenuEntry[])[]): readonly CommandMenuEntry[] {
  return blocks
    .filter((block) => block.length > 0)
    .flatMap((block, index) => (index === 0 ? block : ["separator" as const, ...block]));
}

/** A command as an entry. */
export function entryOf(source: MenuSource, command: UserCommand): CommandMenuEntry {
  const { commands, context } = source;
  const [key] = source.keys(command.id);
  const refusal = refusalOf(command, context);
  const disabled = refusal !== null;
  const detail = refusal || command.detail;
  const entry = {
    id: command.id,
    title: command.title,
    disabled,
    ...(key === undefined ? {} : { keys: shownKey(key) }),
    ...(detail === undefined ? {} : { detail }),
    ...(command.checked ? { checked: command.checked(context) } : {}),
  };
  if (!command.choices) return { ...entry, run: () => void commands.choose(command, context) };
  const items = command.choices(context).map((choice, index) => ({
    id: `${command.id}/${index}`,
    title: choice.title,
    ...(choice.detail === undefined ? {} : { detail: choice.detail }),
    ...(choice.checked === undefined ? {} : { checked: choice.checked }),
    ...(choice.disabled === undefined ? {} : { disabled: choice.disabled }),
    run: () => void commands.choose(command, context, choice),
  }));
  return { ...entry, disabled: disabled || items.length === 0, items };
}

interface InnerMenu {
  readonly title: string;
  readonly of: readonly CommandId[];
}

/** A context menu: ids of commands, blocks of them, and menus inside by title. */
type Recipe = readonly (readonly (CommandId | InnerMenu)[])[];

const CLIPBOARD: readonly CommandId[] = [
  "edit.cut",
  "edit.copy",
  "edit.paste",
  "edit.duplicate",
  "edit.delete",
];

const ADD: InnerMenu = {
  title: "Add",
  of: [
    "insert.execution",
    "insert.hierarchy",
    "insert.barrier",
    "insert.preemptive",
    "insert.library",
    "insert.outcome",
    "insert.input",
    "insert.output",
    "insert.scoped-variable",
  ],
};

const CONNECT: InnerMenu = {
  title: "Connect",
  of: [
    "insert.connect",
    "insert.transition-from-sibling",
    "insert.transition-to-sibling",
    "insert.transition-to-parent",
  ],
};

const ARRANGE: InnerMenu = {
  title: "Align and distribute",
  of: [
    "arrange.align-left",
    "arrange.align-centre",
    "arrange.align-right",
    "arrange.align-top",
    "arrange.align-middle",
    "arrange.align-bottom",
    "arrange.distribute-horizontal",
    "arrange.distribute-vertical",
  ],
};

/** All that arranges a state and what is inside. */
const LAYOUT: InnerMenu = {
  title: "Layout",
  of: [...ARRANGE.of, "arrange.layout-level", "arrange.layout-all", "arrange.fit-content"],
};

const RUN: InnerMenu = {
  title: "Run",
  of: ["run.start-here", "run.stop-here", "run.selected", "run.only-selected"],
};

const BREAK: readonly CommandId[] = [
  "run.breakpoint",
  "run.edit-breakpoint",
  "run.force-outcome",
  "run.preempt",
];

const STATE: Recipe = [
  ["arrange.start-state", RUN],
  [ADD, CONNECT],
  CLIPBOARD,
  ["edit.rename", "arrange.group", "arrange.ungroup", "arrange.substitute", "arrange.change-kind"],
  [LAYOUT],
  BREAK,
  ["file.save-state", "arrange.background"],
  ["view.zoom-selection"],
];

const LIBRARY: Recipe = [
  ["view.library-content", "arrange.show-content", "file.open-library", "file.show-library"],
  ["arrange.start-state", RUN],
  [CONNECT, ARRANGE],
  CLIPBOARD,
  ["edit.rename", "arrange.group", "arrange.substitute", "arrange.substitute-template"],
  BREAK,
  ["arrange.background"],
  ["view.zoom-selection"],
];

const IN_LIBRARY: Recipe = [
  ["edit.copy", "view.library-content", "file.open-library"],
  [RUN],
  BREAK,
  ["view.zoom-selection"],
];

const PORT: Recipe = [
  ["edit.rename", "insert.connect"],
  ["edit.cut", "edit.copy", "edit.paste", "edit.delete"],
];

const DATA_FLOW: Recipe = [["arrange.clear-waypoints"], ["edit.delete"], ["view.zoom-selection"]];

const TRANSITION: Recipe = [["insert.into-transition"], ...DATA_FLOW];

const CANVAS: Recipe = [
  [ADD, "edit.paste", "edit.select-all"],
  ["arrange.layout-level", "arrange.layout-all"],
  [
    "view.fit",
    "view.data-flows",
    "view.transitions",
    "view.names",
    "view.values",
    "view.aborted",
    "view.grid",
  ],
];

/** The menu of what was clicked: of a state, library, port, connection, or of the canvas itself. */
export function contextMenu(
  source: MenuSource,
  elements: readonly ElementRef[],
): readonly CommandMenuEntry[] {
  const recipe = recipeFor(source.context, elements);
  return joined(recipe.map((block) => block.flatMap((part) => entriesOf(source, part))));
}

function entriesOf(source: MenuSource, part: Recipe[number][number]): readonly CommandMenuEntry[] {
  if (typeof part === "string") {
    const command = source.commands.get(part);
    return command ? [entryOf(source, command)] : [];
  }
  const items = part.of.flatMap((id) => entriesOf(source, id));
  const disabled = items.every((item) => item === "separator" || item.disabled);
  return items.length === 0 ? [] : [{ id: part.title, title: part.title, items, disabled }];
}

function recipeFor({ tab }: CommandContext, elements: readonly ElementRef[]): Recipe {
  const [first] = elements;
  if (!first || !tab) return CANVAS;
  const { machine } = tab.session;
  if (machine.isInLibrary(first.path)) return IN_LIBRARY;
  switch (first.kind) {
    case "state": {
      const only = elements.length === 1;
      return only && machine.state(first.path)?.kind === "library" ? LIBRARY : STATE;
    }
    case "transition":
      return TRANSITION;
    case "data_flow":
      return DATA_FLOW;
    default:
      return PORT;
  }
}
