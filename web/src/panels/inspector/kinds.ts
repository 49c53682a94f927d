/** Icons of the kinds of states, and names for all selectable elements. */

import {
  ArrowRight,
  CircleArrowOutUpRight,
  CircleArrowRight,
  GitFork,
  Layers,
  Library,
  LogOut,
  type LucideIcon,
  Split,
  SquareCode,
  Variable,
  Waypoints,
  Zap,
} from "lucide-react";
import type { ElementKind } from "../../model/element.ts";
import type { StateKind } from "../../model/generated/protocol.ts";

export const KIND_ICONS: Readonly<Record<StateKind, LucideIcon>> = {
  execution: SquareCode,
  hierarchy: Layers,
  barrier: GitFork,
  preemptive: Zap,
  decider: Split,
  library: Library,
};

export const ELEMENT_ICONS: Readonly<Record<Exclude<ElementKind, "state" | "income">, LucideIcon>> =
  {
    outcome: LogOut,
    input: CircleArrowRight,
    output: CircleArrowOutUpRight,
    scoped_variable: Variable,
    transition: ArrowRight,
    data_flow: Waypoints,
  };

export const ELEMENT_WORDS: Readonly<Record<ElementKind, string>> = {
  state: "state",
  income: "income",
  outcome: "outcome",
  input: "input",
  output: "output",
  scoped_variable: "scoped variable",
  transition: "transition",
  data_flow: "data flow",
};

/** Such as `1 state`, `1,300 data flows`. */
export function counted(count: number, word: string): string {
  return `${count.toLocaleString("en")} ${word}${count === 1 ? "" : "s"}`;
}
