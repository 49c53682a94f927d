/** Commands of the Arrange menu: group, substitute, align, lay out and colour states. */

import type { StateKind } from "../model/generated/protocol.ts";
import { readLayout } from "../model/layout_reader.ts";
import { isContainer, type Machine, startOf } from "../model/machine.ts";
import { idOf, parentOf } from "../model/path.ts";
import { boxIn, childBoxes } from "../plan/boxes.ts";
import { group, substitute } from "../plan/group.ts";
import {
  type Alignment,
  align,
  distribute,
  resize,
  setBackground,
  setWaypoints,
  showContent,
} from "../plan/move.ts";
import { libraryState } from "../plan/newcomers.ts";
import { isRefused, type Planned, refused } from "../plan/plan.ts";
import { changeKind, clearStart, setStart } from "../plan/states.ts";
import { ungroup } from "../plan/ungroup.ts";
import type { Substitution } from "../store/page/command_arguments.ts";
import type { OpenTab } from "../store/page/page.ts";
import type { CommandContext, MenuPlace, Rgb, UserCommand } from "./command.ts";
import { workingContainerOf } from "./edit.ts";
import { libraryMachine } from "./insert.ts";
import { layoutOf } from "./layout_work.ts";
import { perform } from "./perform.ts";
import {
  canEdit,
  elements,
  kindOfOnly,
  machineOf,
  onlyElement,
  onlyState,
  siblings,
  states,
} from "./subject.ts";

const TOGETHER: readonly UserCommand[] = [
  {
    id: "arrange.group",
    title: "Group",
    detail: "Moves the selected states and scoped variables into a new hierarchy.",
    keys: ["G"],
    classic: ["Ctrl+G", "G"],
    menu: "Arrange/1",
    needs: "select states of one container",
    enabled: (context) => canEdit(context) && siblings(context, 1),
    run: (context) =>
      perform(context, (m) => {
        const variables = elements(context).flatMap((element) =>
          element.kind === "scoped_variable" ? [element.id] : [],
        );
        return group(m, states(context), variables);
      }),
  },
  {
    id: "arrange.ungroup",
    title: "Ungroup",
    keys: ["U"],
    classic: ["Ctrl+Shift+G", "Ctrl+U", "U"],
    menu: "Arrange/1",
    needs: "select one hierarchy or concurrency inside the machine",
    enabled: (context) => canEdit(context) && isInnerContainer(context),
    run: (context) => onState(context, ungroup),
  },
  {
    id: "arrange.substitute",
    title: "Substitute by library…",
    keys: ["Ctrl+Shift+Alt+U"],
    menu: "Arrange/1",
    needs: "select a state inside the machine, not the machine itself",
    enabled: (context) => canEdit(context) && isInner(context),
    run: substituteByLibrary,
  },
  {
    id: "arrange.substitute-template",
    title: "Substitute by the library's content",
    detail: "Its states become editable states of this machine.",
    menu: "Arrange/1",
    enabled: (context) => canEdit(context) && isInner(context) && kindOfOnly(context) === "library",
    choices: () => [
      { title: "Keep the state's name", argument: true },
      { title: "Take the library's name", argument: false },
    ],
    run: substituteByContent,
  },
  {
    id: "arrange.change-kind",
    title: "Change kind",
    menu: "Arrange/1",
    enabled: (context) => {
      const kind = kindOfOnly(context);
      return canEdit(context) && kind !== null && kind !== "library" && kind !== "decider";
    },
    choices: (context) =>
      KINDS.map(([kind, title]) => ({
        title,
        argument: kind,
        checked: kindOfOnly(context) === kind,
        disabled: kindOfOnly(context) === kind,
      })),
    run: (context, argument) =>
      argument && onState(context, (m, path) => changeKind(m, path, argument)),
  },
  {
    id: "arrange.start-state",
    title: "Is start state",
    keys: ["Ctrl+E"],
    classic: ["Ctrl+E", "Ctrl+Shift+X"],
    menu: "Arrange/1",
    needs: "select one state of a hierarchy",
    enabled: (context) => canEdit(context) && canStart(context),
    checked: isStart,
    run: (context) =>
      onState(context, (m, path) =>
        isStart(context) ? clearStart(m, parentOf(path) ?? "") : setStart(m, path),
      ),
  },
];

const KINDS: readonly (readonly [StateKind, string])[] = [
  ["execution", "Execution state"],
  ["hierarchy", "Hierarchy"],
  ["barrier", "Barrier concurrency"],
  ["preemptive", "Preemptive concurrency"],
];

function onState(context: CommandContext, plan: (machine: Machine, path: string) => Planned) {
  return perform(context, (m) => {
    const path = onlyState(context);
    return path === null ? refused("Select one state first.") : plan(m, path);
  });
}

/** One state is selected, and it is neither the root nor a decider. */
function isInner(context: CommandContext): boolean {
  const path = onlyState(context);
  return path !== null && parentOf(path) !== null && kindOfOnly(context) !== "decider";
}

function isInnerContainer(context: CommandContext): boolean {
  const path = onlyState(context);
  const state = path === null ? undefined : machineOf(context)?.state(path);
  return state !== undefined && isContainer(state) && isInner(context);
}

function canStart(context: CommandContext): boolean {
  const parent = parentOf(onlyState(context) ?? "");
  return parent !== null && machineOf(context)?.state(parent)?.kind === "hierarchy";
}

function isStart(context: CommandContext): boolean {
  const path = onlyState(context);
  const container = machineOf(context)?.state(parentOf(path ?? "") ?? "");
  return path !== null && container !== undefined && startOf(container)?.to_state === idOf(path);
}

async function substituteByLibrary(context: CommandContext, given?: Substitution): Promise<void> {
  const path = given?.path ?? onlyState(context);
  const old = path === null ? undefined : machineOf(context)?.state(path);
  if (path === null || !old) return;
  const library =
    given?.library ??
    (await context.shell.dialog("library", {
      title: `Substitute “${old.name}” by a library`,
      yes: "Substitute",
    }));
  if (!library) return;
  const { states, version } = await libraryMachine(context, library);
  const [root] = states;
  await perform(context, (machine) => {
    if (!root) return refused(`The library ${library.name} is empty.`);
    const state = libraryState(
      idOf(path),
      root.name,
      { ...library, version },
      root,
      boxIn(machine, path),
    );
    return substitute(machine, path, [state], true);
  });
}

async function substituteByContent(context: CommandContext, keepsName = true): Promise<void> {
  const path = onlyState(context);
  const library = path === null ? undefined : machineOf(context)?.state(path)?.library;
  if (path === null || !library) return;
  const { states } = await libraryMachine(context, library);
  await perform(context, (m) => substitute(m, path, states, keepsName));
}

const ALIGNMENTS: readonly (readonly [Alignment, string])[] = [
  ["left", "Left edges"],
  ["centre", "Centres"],
  ["right", "Right edges"],
  ["top", "Top edges"],
  ["middle", "Middles"],
  ["bottom", "Bottom edges"],
];

const LINE_UP: MenuPlace = "Arrange/2/Align and distribute";

const LINED_UP: readonly UserCommand[] = [
  ...ALIGNMENTS.map(
    ([to, title]): UserCommand => ({
      id: `arrange.align-${to}`,
      title: `Align: ${title.toLowerCase()}`,
      menu: LINE_UP,
      enabled: (context) => canEdit(context) && siblings(context, 2),
      run: (context: CommandContext) => perform(context, (m) => align(m, states(context), to)),
    }),
  ),
  ...(["horizontal", "vertical"] as const).map(
    (along): UserCommand => ({
      id: `arrange.distribute-${along}`,
      title: `Distribute ${along}ly`,
      menu: LINE_UP,
      enabled: (context) => canEdit(context) && siblings(context, 3),
      run: (context: CommandContext) =>
        perform(context, (m) => distribute(m, states(context), along)),
    }),
  ),
];

async function layOutFrom(context: CommandContext, container: string | null, deep: boolean) {
  const { tab } = context;
  const machine = machineOf(context);
  if (!tab || !machine || container === null) return;
  const version = machine.version;
  const levels = await layoutOf(tab, machine, container, deep);
  if (!levels) return;
  const { arranged } = await import("../plan/arranged.ts");
  const isMade = await perform(context, (now) =>
    now.version === version
      ? arranged(now, container, levels)
      : refused("The machine changed while its layout was computed. Try again."),
  );
  // Only the root takes another size.
  if (isMade && container === machine.root) context.canvas?.fit([]);
}

/** Shows a machine without a drawing arranged; false if that is not possible. It is an edit once the user keeps it, edits or saves. */
export async function proposeLayout(tab: OpenTab): Promise<boolean> {
  const { proposal, machine } = tab.session;
  while (proposal?.isDue.peek()) {
    const version = machine.version;
    const levels = await layoutOf(tab, machine, machine.root, true);
    const { arranged } = await import("../plan/arranged.ts");
    if (!levels) return false;
    if (machine.version !== version) continue;
    const plan = arranged(machine, machine.root, levels);
    if (isRefused(plan)) return false;
    proposal.show(plan);
    return true;
  }
  return false;
}

/** The current level: the container of the selection, or the one that is being edited. */
function levelToLayOut(context: CommandContext): string | null {
  const [first] = elements(context);
  if (first?.kind === "state") return parentOf(first.path) ?? first.path;
  return first?.path ?? workingContainerOf(context);
}

/** The container that is laid out with all inside: the one that is selected, else the one that one works in. */
function containerToLayOut(context: CommandContext): string | null {
  const path = onlyState(context);
  const state = path === null ? undefined : machineOf(context)?.state(path);
  return path !== null && state && isContainer(state) ? path : workingContainerOf(context);
}

const LAID_OUT: readonly UserCommand[] = [
  {
    id: "arrange.layout-level",
    title: "Automatic layout of this level",
    keys: ["Ctrl+Shift+L"],
    menu: "Arrange/3",
    needs: "select something in this machine, not in a library",
    enabled: (context) => canEdit(context) && levelToLayOut(context) !== null,
    run: (context) => layOutFrom(context, levelToLayOut(context), false),
  },
  {
    id: "arrange.layout-all",
    title: "Automatic layout of all levels inside",
    keys: ["Ctrl+Shift+Alt+L"],
    menu: "Arrange/3",
    needs: "select something in this machine, not in a library",
    enabled: (context) => canEdit(context) && containerToLayOut(context) !== null,
    run: (context) => layOutFrom(context, containerToLayOut(context), true),
  },
  {
    id: "arrange.keep-layout",
    title: "Keep the automatic layout",
    detail: "Makes the layout that is shown for a machine without one a step of the history.",
    enabled: (context) => canEdit(context) && context.tab?.session.proposal?.shown.value != null,
    run: (context) => context.tab?.session.proposal?.keep(),
  },
  {
    id: "arrange.fit-content",
    title: "Size to content",
    detail: "Removes free space on the right and at the bottom.",
    menu: "Arrange/3",
    enabled: (context) => {
      const path = onlyState(context);
      return canEdit(context) && (machineOf(context)?.children(path ?? "").length ?? 0) > 0;
    },
    run: (context) => onState(context, fitted),
  },
  {
    id: "arrange.clear-waypoints",
    title: "Remove waypoints",
    menu: "Arrange/3",
    enabled: (context) => canEdit(context) && onlyConnection(context) !== null,
    run: (context) => {
      const line = onlyConnection(context);
      return line && perform(context, (m) => setWaypoints(m, line, []));
    },
  },
];

function onlyConnection(context: CommandContext) {
  return onlyElement(context, "transition") ?? onlyElement(context, "data_flow");
}

/** The state as small as its content lets it be, with a margin. */
function fitted(machine: Machine, path: string): Planned {
  const box = boxIn(machine, path);
  const inner = [...childBoxes(machine, path).values()];
  const right = Math.max(...inner.map((child) => child.x + child.width));
  const lower = Math.max(...inner.map((child) => child.y + child.height));
  const margin = Math.min(right, lower) * 0.08;
  const size = { width: right + margin, height: lower + margin };
  return resize(machine, path, { x: box.x, y: box.y, ...size }, false);
}

const LOOKS: readonly UserCommand[] = [
  {
    id: "arrange.background",
    title: "Background colour…",
    menu: "Arrange/4",
    enabled: (context) => canEdit(context) && states(context).length === 1,
    run: async (context) => {
      const state = machineOf(context)?.state(onlyState(context) ?? "");
      if (!state) return;
      const before = rgbOfCss(readLayout(state).background);
      const chosen = await context.shell.dialog("colour", before);
      if (chosen) await onState(context, (m, path) => setBackground(m, path, chosen.rgb));
    },
  },
  {
    id: "arrange.show-content",
    title: "Show library content when opened",
    detail: "Saved with the machine, for everyone.",
    menu: "Arrange/4",
    enabled: (context) => canEdit(context) && kindOfOnly(context) === "library",
    checked: (context) => {
      const state = machineOf(context)?.state(onlyState(context) ?? "");
      return state !== undefined && readLayout(state).showsContent;
    },
    run: (context) =>
      onState(context, (m, path) => {
        const state = m.state(path);
        return showContent(m, path, !(state && readLayout(state).showsContent));
      }),
  },
];

/** A colour as CSS has it, as files have it. */
function rgbOfCss(css: string | undefined): Rgb | null {
  const [red, green, blue] = (css?.match(/\d+/g) ?? []).map((part) => Number(part) / 255);
  return red === undefined || green === undefined || blue === undefined ? null : [red, green, blue];
}

export const ARRANGE: readonly UserCommand[] = [
  ...TOGETHER,
  ...LINED_UP,
  ...LAID_OUT,
  ...LOOKS,
].map((command) => ({ ...command, edits: true, once: true }));
