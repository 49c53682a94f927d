/** Commands of the Edit menu: undo and redo, clipboard, selection. */

import type { ElementRef } from "../model/element.ts";
import { boundsOf, intersects, type Point } from "../model/geometry.ts";
import { type Machine, outcomesOf, portsOf, startOf } from "../model/machine.ts";
import { childPath, parentOf } from "../model/path.ts";
import { boxIn, childBoxes, sizeIn } from "../plan/boxes.ts";
import { duplicate, pasteClip } from "../plan/clipboard.ts";
import { isRefused } from "../plan/plan.ts";
import { renameOutcome, renamePort } from "../plan/ports.ts";
import { removeElements } from "../plan/states.ts";
import type { TextTransfer } from "../store/page/command_arguments.ts";
import { searchRevealRequest } from "../store/page/reveal_requests.ts";
import { select, selected } from "../store/page/view.ts";
import { copyElements, NOTHING_COPIED, read } from "./clipboard.ts";
import type { CommandContext, UserCommand } from "./command.ts";
import { perform } from "./perform.ts";
import { canEdit, containerOf, elements, ownerForNew, placeForNew, states } from "./subject.ts";

const hasSelection = ({ tab }: CommandContext) => (tab?.view.selection.value.size ?? 0) > 0;
const canChange = (context: CommandContext) => canEdit(context) && elements(context).length > 0;
const hasStates = (context: CommandContext) => canEdit(context) && states(context).length > 0;

export const EDIT: readonly UserCommand[] = [
  {
    id: "edit.undo",
    edits: true,
    title: "Undo",
    detail: "Undoes your own last step.",
    keys: ["Ctrl+Z"],
    menu: "Edit/1",
    enabled: canEdit,
    run: ({ tab }) => tab?.session.undo(),
  },
  {
    id: "edit.redo",
    edits: true,
    title: "Redo",
    keys: ["Ctrl+Y", "Ctrl+Shift+Z"],
    menu: "Edit/1",
    enabled: canEdit,
    run: ({ tab }) => tab?.session.redo(),
  },
  {
    id: "edit.cut",
    edits: true,
    title: "Cut",
    keys: ["Ctrl+X"],
    menu: "Edit/2",
    needs: "select something first",
    enabled: canChange,
    run: async (context, argument) => {
      const cut = elements(context);
      if (await copy(context, argument ?? null))
        await perform(context, (m) => removeElements(m, cut));
    },
  },
  {
    id: "edit.copy",
    title: "Copy",
    keys: ["Ctrl+C"],
    menu: "Edit/2",
    needs: "select something first",
    enabled: hasSelection,
    run: (context, argument) => copy(context, argument ?? null),
  },
  {
    id: "edit.paste",
    edits: true,
    title: "Paste",
    detail:
      "Pastes states at the pointer or into the selected container, ports and outcomes into the state.",
    keys: ["Ctrl+V"],
    menu: "Edit/2",
    enabled: canEdit,
    run: async (context, argument) => {
      const goal = { container: placeForNew(context), owner: ownerForNew(context) };
      const clip = await read(argument ?? null);
      if (clip) await perform(context, (m) => pasteClip(m, clip, goal));
      else context.page.tell({ level: "info", text: NOTHING_COPIED });
    },
  },
  {
    id: "edit.duplicate",
    edits: true,
    title: "Duplicate",
    keys: ["Ctrl+D"],
    classic: ["Ctrl+Shift+D"],
    menu: "Edit/2",
    needs: "select a state first",
    enabled: hasStates,
    run: (context) =>
      perform(context, (m) => {
        const paths = states(context);
        return duplicate(m, paths, besides(m, paths));
      }),
  },
  {
    id: "edit.delete",
    edits: true,
    title: "Delete",
    keys: ["Delete", "Backspace"],
    menu: "Edit/2",
    needs: "select something first",
    enabled: canChange,
    run: (context, argument) => {
      const gone = argument ?? elements(context);
      return perform(context, (m) => removeElements(m, gone));
    },
  },
  {
    id: "edit.select-all",
    title: "Select all",
    detail: "Selects all states of the current container.",
    keys: ["Ctrl+A"],
    classic: ["Ctrl+Shift+Alt+A"],
    menu: "Edit/3",
    enabled: ({ tab }) => tab !== null,
    run: (context) => {
      const { tab } = context;
      const around = workingContainerOf(context);
      if (!tab || around === null) return;
      const paths = tab.session.machine.children(around);
      select(
        tab.view,
        paths.map((path) => ({ kind: "state" as const, path })),
      );
    },
  },
  {
    id: "edit.select-start",
    title: "Select start state",
    keys: ["S"],
    menu: "Edit/3",
    enabled: ({ tab }) => tab !== null,
    run: selectStart,
  },
  {
    id: "edit.select-none",
    title: "Clear selection",
    menu: "Edit/3",
    enabled: hasSelection,
    run: ({ tab }) => {
      if (tab) select(tab.view, []);
    },
  },
  {
    id: "edit.rename",
    edits: true,
    title: "Rename",
    keys: ["F2"],
    menu: "Edit/4",
    needs: "select a state, port or outcome first",
    enabled: (context) => canEdit(context) && nameable(context) !== null,
    run: rename,
  },
  {
    id: "edit.find",
    title: "Find…",
    detail: "Searches names, ids, ports, descriptions, scripts, values and libraries.",
    keys: ["Ctrl+F", "/"],
    menu: "Edit/4",
    enabled: ({ tab }) => tab !== null,
    run: ({ shell }) => {
      shell.showPanel("search");
      searchRevealRequest.value += 1;
    },
  },
];

/** Offset of duplicates: beside or below the originals if there is room, otherwise slightly shifted. */
export function besides(machine: Machine, paths: readonly string[]): Point {
  const own = boundsOf(paths.map((path) => boxIn(machine, path)));
  const container = parentOf(paths[0] ?? "");
  if (!own || container === null) return { x: 0, y: 0 };
  const size = sizeIn(machine, container);
  const taken = [...childBoxes(machine, container).values()];
  const isFree = ({ x, y }: Point) => {
    const box = { ...own, x: own.x + x, y: own.y + y };
    const fits = box.x + box.width <= size.width && box.y + box.height <= size.height;
    return fits && !taken.some((other) => intersects(box, other));
  };
  const steps = [
    { x: own.width * 1.2, y: 0 },
    { x: 0, y: own.height * 1.2 },
  ];
  const shift = Math.min(own.width, own.height) * 0.12;
  return steps.find(isFree) ?? { x: shift, y: shift };
}

async function copy(context: CommandContext, transfer: TextTransfer | null): Promise<boolean> {
  const { page, tab } = context;
  if (!tab) return false;
  const refusal = await copyElements(tab.session.machine, selected(tab.view), transfer);
  if (refusal !== null) page.tell({ level: "warning", text: refusal });
  return refusal === null;
}

/** The container that one works in: the one that fills the view, or the one around what is selected. */
export function workingContainerOf(context: CommandContext): string | null {
  return context.canvas?.workingContainer.value ?? containerOf(context);
}

function selectStart(context: CommandContext): void {
  const { tab, canvas } = context;
  const path = workingContainerOf(context);
  const container = path === null ? undefined : tab?.session.machine.state(path);
  const start = container && startOf(container)?.to_state;
  if (!tab || path === null || !start) {
    context.page.tell({ level: "info", text: `${container?.name ?? "This state"} has no start.` });
    return;
  }
  const element = { kind: "state", path: childPath(path, start) } as const;
  select(tab.view, [element]);
  canvas?.reveal(element);
}

/** The one selected element that has a name of its own. */
function nameable(context: CommandContext): ElementRef | null {
  const [element, ...more] = elements(context);
  if (!element || more.length > 0) return null;
  const named = ["state", "outcome", "input", "output", "scoped_variable"];
  return named.includes(element.kind) ? element : null;
}

async function rename(context: CommandContext): Promise<void> {
  const element = nameable(context);
  const state = element && context.tab?.session.machine.state(element.path);
  if (!element || !state) return;
  if (element.kind === "state") {
    context.canvas?.rename(element.path);
    return;
  }
  if (!("id" in element) || element.kind === "transition" || element.kind === "data_flow") return;
  const { kind, id } = element;
  const parts = kind === "outcome" ? outcomesOf(state) : portsOf(state, kind);
  const before = parts.find((part) => part.id === id)?.name ?? "";
  const plan = (name: string) => (machine: Machine) =>
    kind === "outcome" ? renameOutcome(machine, element, name) : renamePort(machine, element, name);
  const name = await context.shell.prompt({
    title: `Rename ${kind.replace("_", " ")}`,
    label: "Name",
    initial: before,
    check: (text) => {
      const { tab } = context;
      const planned = tab && text !== before ? plan(text)(tab.session.machine) : null;
      return planned && isRefused(planned) ? planned.refused : null;
    },
  });
  if (name !== null && name !== before) await perform(context, plan(name));
}
