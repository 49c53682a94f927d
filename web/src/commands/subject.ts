/** The selection as the subject of commands, and the rules for editing it. */

import { type ElementRef, elementOf } from "../model/element.ts";
import type { StateDocument, StateKind } from "../model/generated/protocol.ts";
import type { Point } from "../model/geometry.ts";
import { isContainer, type Machine } from "../model/machine.ts";
import { parentOf } from "../model/path.ts";
import { stateAt } from "../plan/legal.ts";
import { isRefused } from "../plan/plan.ts";
import { mayEdit } from "../store/page/rights.ts";
import { selected, selectedStates } from "../store/page/view.ts";
import type { CommandContext } from "./command.ts";

/** True if the current machine can be edited. */
export function canEdit(context: CommandContext): boolean {
  return context.tab !== null && context.tab.session.fixed === null && mayEdit(context.page);
}

export function machineOf(context: CommandContext): Machine | null {
  return context.tab?.session.machine ?? null;
}

/** All that is selected and may be changed: nothing inside libraries. */
export function elements(context: CommandContext): readonly ElementRef[] {
  const { tab } = context;
  if (!tab) return [];
  const { machine } = tab.session;
  return selected(tab.view).filter((element) => !machine.isInLibrary(element.path));
}

/** Paths of the selected states that may be changed. */
export function states(context: CommandContext): readonly string[] {
  return elements(context).flatMap((each) => (each.kind === "state" ? [each.path] : []));
}

/** The path of the one state that is selected; null if there are none or several. */
export function onlyState(context: CommandContext): string | null {
  const [path, ...more] = states(context);
  return path !== undefined && more.length === 0 && elements(context).length === 1 ? path : null;
}

/** The one selected state itself, also one inside a library. */
export function anyOnlyState(
  context: CommandContext,
): { path: string; state: StateDocument } | null {
  const { tab } = context;
  const paths = tab ? selectedStates(tab.view) : [];
  const [path] = paths;
  const state = path === undefined ? undefined : tab?.session.machine.state(path);
  return paths.length === 1 && path !== undefined && state ? { path, state } : null;
}

/** The library state that is selected, or that what is selected lies in. */
export function libraryAround(context: CommandContext): StateDocument | null {
  const machine = machineOf(context);
  let path = anyOnlyState(context)?.path ?? null;
  for (; machine && path !== null; path = parentOf(path)) {
    const state = machine.state(path);
    if (state?.kind === "library") return state;
    if (!machine.isInLibrary(path)) return null;
  }
  return null;
}

/** Reason why the selection cannot be changed, if all of it belongs to libraries. */
export function whyNot(context: CommandContext): string | null {
  const machine = machineOf(context);
  const [first] = context.tab ? selected(context.tab.view) : [];
  if (!machine || !first || elements(context).length > 0) return null;
  const state = stateAt(machine, first.path);
  return isRefused(state) ? state.refused : null;
}

/** The kind of the one selected state that may be changed. */
export function kindOfOnly(context: CommandContext): StateKind | null {
  const path = onlyState(context);
  return path === null ? null : (machineOf(context)?.state(path)?.kind ?? null);
}

/** The state around what is selected: of a state the state itself if it takes others. */
export function containerOf(context: CommandContext): string | null {
  const machine = machineOf(context);
  const first = elements(context)[0];
  if (!machine) return null;
  let path: string | null = first?.path ?? machine.root;
  for (; path !== null; path = parentOf(path)) {
    const state = machine.state(path);
    if (state && isContainer(state) && !machine.isInLibrary(path)) return path;
  }
  return null;
}

/** Place of a new element: under the pointer on the canvas, or in the selected container. */
export function placeForNew(context: CommandContext): { path: string; at?: Point } | null {
  const under = context.canvas?.pointer() ?? null;
  const machine = machineOf(context);
  const state = under && machine?.state(under.path);
  if (under && state && isContainer(state) && !machine?.isInLibrary(under.path)) {
    return { path: under.path, at: under.at };
  }
  const path = containerOf(context);
  return path === null ? null : { path };
}

/** Which state would get new ports and outcomes: the one that all that is selected belongs to, else the one under the pointer. */
export function ownerForNew(context: CommandContext): string | null {
  const paths = new Set(elements(context).map(({ path }) => path));
  const [path] = paths;
  if (path !== undefined && paths.size === 1) return path;
  return context.canvas?.pointer()?.path ?? null;
}

/** True if all selected states are in one container, as group and align require. */
export function siblings(context: CommandContext, count: number): boolean {
  const paths = states(context);
  const parent = paths[0] === undefined ? null : parentOf(paths[0]);
  return (
    parent !== null && paths.length >= count && paths.every((path) => parentOf(path) === parent)
  );
}

/** The one selected connection of this kind. */
export function onlyElement<K extends ElementRef["kind"]>(
  context: CommandContext,
  kind: K,
): Extract<ElementRef, { kind: K }> | null {
  const [key, ...more] = context.tab?.view.selection.value ?? [];
  const element = key === undefined ? null : elementOf(key);
  if (more.length > 0 || element?.kind !== kind) return null;
  return element as Extract<ElementRef, { kind: K }>;
}
