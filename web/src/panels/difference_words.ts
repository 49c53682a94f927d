/** Texts about differences. */

import type { Difference } from "../model/difference.ts";
import type { ElementKind } from "../model/element.ts";
import { type Machine, namesTo } from "../model/machine.ts";
import { parentOf } from "../model/path.ts";

export const KIND_WORDS: Readonly<Record<ElementKind, string>> = {
  state: "State",
  income: "Income",
  outcome: "Outcome",
  input: "Input",
  output: "Output",
  scoped_variable: "Scoped variable",
  transition: "Transition",
  data_flow: "Data flow",
};

/** Short description of a change. */
export function summary(difference: Difference): string {
  if (difference.inside > 0) {
    return difference.inside === 1
      ? "with 1 state inside"
      : `with ${difference.inside} states inside`;
  }
  if (difference.isLayout) return "position on the canvas";
  return difference.fields
    .map(({ field, old, now, isText }) =>
      isText ? field : `${field}: ${shown(old)} → ${shown(now)}`,
    )
    .join(" · ");
}

function shown(text: string): string {
  return text === "" ? "–" : text;
}

/** Names of the states around the element, including the state that a part belongs to. */
export function whereabouts(machine: Machine, { element }: Difference): string {
  const path = element.kind === "state" ? parentOf(element.path) : element.path;
  return path === null ? "" : namesTo(machine, path).join(" / ");
}
