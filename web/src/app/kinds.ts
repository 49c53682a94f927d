/** Signs and words of the kinds of states. */

import { GitFork, Layers, Library, type LucideIcon, Split, SquareCode, Zap } from "lucide-react";
import type { StateKind } from "../model/generated/protocol.ts";

export const KIND_ICONS: Readonly<Record<StateKind, LucideIcon>> = {
  execution: SquareCode,
  hierarchy: Layers,
  barrier: GitFork,
  preemptive: Zap,
  decider: Split,
  library: Library,
};

export const KIND_TITLES: Readonly<Record<StateKind, string>> = {
  execution: "Execution state",
  hierarchy: "Hierarchy",
  barrier: "Barrier concurrency",
  preemptive: "Preemptive concurrency",
  decider: "Decider",
  library: "Library state",
};

/** The kinds that can be put into a container, in the order of the palette. */
export const NEW_KINDS = ["execution", "hierarchy", "barrier", "preemptive"] as const;
