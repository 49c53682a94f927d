/** Where mission control stands: beside the canvas, as high as the page; on a narrow screen above it, as wide as the page. */

import type { DockviewApi } from "dockview-react";
import { MISSION_PANEL } from "../commands/mission.ts";

/** Narrower pages have one column. */
export const NARROW = "(max-width: 900px)";

/** What of a narrow page's height it takes, and of a wide one's width at most. */
const HEIGHT_SHARE = 0.64;
const WIDTH_SHARE = 0.55;
const WIDTH = 600;

/** Puts mission control where it belongs on such a page, if it stands alone in the grid; true if it was moved. */
export function placeMission(api: DockviewApi, isNarrow: boolean): boolean {
  const panel = api.getPanel(MISSION_PANEL);
  if (panel?.group.api.location.type !== "grid" || panel.group.size > 1) return false;
  const isAbove = panel.group.api.width >= api.width - 2;
  if (isAbove !== isNarrow) panel.group.api.moveTo({ position: isNarrow ? "top" : "left" });
  const size = isNarrow
    ? { height: api.height * HEIGHT_SHARE }
    : { width: Math.min(WIDTH, api.width * WIDTH_SHARE) };
  panel.group.api.setSize(size);
  return isAbove !== isNarrow;
}
