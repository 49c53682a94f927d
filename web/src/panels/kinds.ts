/** Icons and names of the kinds of states, for lists. */

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
