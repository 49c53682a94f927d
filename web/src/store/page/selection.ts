/** Limits the selection and the hovered element to existing elements. */

import { type ElementRef, elementOf } from "../../model/element.ts";
import { type Machine, outcomesOf, portsOf } from "../../model/machine.ts";
import type { SessionView } from "./view.ts";

/** True if the machine has the element. */
export function isThere(machine: Machine, element: ElementRef): boolean {
  const state = machine.state(element.path);
  if (!state) return false;
  switch (element.kind) {
    case "state":
    case "income":
      return true;
    case "outcome":
      return outcomesOf(state).some(({ id }) => id === element.id);
    case "transition":
      return state.transitions?.some(({ id }) => id === element.id) ?? false;
    case "data_flow":
      return state.data_flows?.some(({ id }) => id === element.id) ?? false;
    default:
      return portsOf(state, element.kind).some(({ id }) => id === element.id);
  }
}

/** Removes missing elements from the selection. */
export function forgetGone(view: SessionView, machine: Machine): void {
  const before = view.selection.peek();
  const kept = [...before].filter((key) => {
    const element = elementOf(key);
    return element !== null && isThere(machine, element);
  });
  if (kept.length < before.size) view.selection.value = new Set(kept);
  const hovered = view.hovered.peek();
  if (hovered && !isThere(machine, hovered)) view.hovered.value = null;
}

/** Paths of all states that are selected or contain a selected element. */
export function touchedStates(view: SessionView): readonly string[] {
  const paths = [...view.selection.value].flatMap((key) => elementOf(key)?.path ?? []);
  return [...new Set(paths)];
}
