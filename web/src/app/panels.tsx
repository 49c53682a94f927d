/** The panels that can be docked: what they are called, where they stand at first, what their tab counts. */

import { Braces, type LucideIcon, SlidersHorizontal } from "lucide-react";
import type { FunctionComponent } from "react";
import type { Side } from "../commands/command.ts";
import { Globals } from "../panels/globals/globals.tsx";
import { Inspector } from "../panels/inspector/inspector.tsx";
import type { OpenTab } from "../store/page.ts";

export interface Panel {
  readonly id: string;
  readonly title: string;
  readonly icon: LucideIcon;
  readonly component: FunctionComponent;
  /** On which side it stands if nobody has put it elsewhere. */
  readonly side: Side;
  /** How many things in it want to be seen. */
  readonly count?: (tab: OpenTab | null) => number;
}

export const PANELS: readonly Panel[] = [
  { id: "globals", title: "Globals", icon: Braces, component: Globals, side: "left" },
  {
    id: "inspector",
    title: "Inspector",
    icon: SlidersHorizontal,
    component: Inspector,
    side: "right",
  },
];

export function panelOf(id: string): Panel | undefined {
  return PANELS.find((panel) => panel.id === id);
}
