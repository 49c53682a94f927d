/** Predefined layouts of the panels, and the sizes of their sides. Pure; the dock applies them. */

import type { PanelSide } from "../commands/command.ts";

/** Panels on one side, as groups: of the left and right side from the top, of the lower side from the left. */
interface LayoutSide {
  /** In CSS pixels: width of the left and right side, height of the lower. */
  readonly size: number;
  readonly groups: readonly (readonly string[])[];
  /** The left side is as high as the page, and the lower side begins beside it. The right side always is. */
  readonly isTall?: boolean;
}

/** Key of the arrangement that this browser has kept. */
export const LAYOUT_KEY = "rafcon.layout";

export type PanelLayout = Partial<Readonly<Record<PanelSide, LayoutSide>>>;

export const SHIPPED: Readonly<Record<string, PanelLayout>> = {
  Edit: {
    left: {
      size: 264,
      groups: [
        ["libraries", "tree", "search"],
        ["globals", "running", "breakpoints", "runs"],
      ],
    },
    right: { size: 344, groups: [["inspector"]] },
    bottom: { size: 188, groups: [["problems", "edits", "differences", "log"]] },
  },
  Debug: {
    left: {
      size: 264,
      groups: [
        ["tree", "search", "libraries"],
        ["running", "breakpoints", "runs", "globals"],
      ],
    },
    right: { size: 380, groups: [["inspector", "watches"]] },
    bottom: {
      size: 280,
      groups: [["timeline", "history", "log", "statistics", "compare", "problems", "edits"]],
    },
  },
  "Mission control": {
    left: { size: 600, isTall: true, groups: [["mission"]] },
    bottom: { size: 190, groups: [["timeline", "log", "history"]] },
  },
};

/** Largest share of a side, because the canvas is the main part. */
const SHARES: Readonly<Record<PanelSide, number>> = { left: 0.22, right: 0.3, bottom: 0.4 };

/** Size of a side on a page of this size. */
export function sizeOn(
  page: { readonly width: number; readonly height: number },
  side: PanelSide,
  { size, isTall }: LayoutSide,
): number {
  const whole = side === "bottom" ? page.height : page.width;
  // The page has no size yet.
  if (isTall || whole === 0) return size;
  return Math.min(size, Math.round(whole * SHARES[side]));
}

/** The layout with the panels that there are, without what would be empty. */
export function withPanels(layout: PanelLayout, isPanel: (id: string) => boolean): PanelLayout {
  const sides = Object.entries(layout).flatMap(([side, { groups, ...more }]) => {
    const kept = groups.map((group) => group.filter(isPanel)).filter((group) => group.length > 0);
    return kept.length === 0 ? [] : [[side, { ...more, groups: kept }] as const];
  });
  return Object.fromEntries(sides);
}
