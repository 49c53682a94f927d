/** Place of mission control: beside the canvas with the height of the page, or above it on a narrow screen. */

import type { DockviewApi } from "dockview-react";
import { MISSION_PANEL } from "../commands/mission.ts";

/** Narrower pages have one column. */
export const NARROW = "(max-width: 900px)";

/** Pages on which panels would leave the canvas next to nothing, as at a zoom of 200 %. */
export const SMALL = `${NARROW}, (max-height: 560px)`;

/** Its share of the height of a narrow page, and largest share of the width of a wide one. */
const HEIGHT_SHARE = 0.64;
/** On a low page it has the room for its buttons and some more first, but for what is left to the canvas. */
const HEIGHT_MIN = 380;
const CANVAS_MIN = 80;
const WIDTH_SHARE = 0.55;
const WIDTH = 600;

/** Moves mission control to its place on such a page if it is alone in its group; true if the place changed. */
export function placeMission(api: DockviewApi, isNarrow: boolean): boolean {
  const group = groupOf(api);
  if (!group || group.api.width >= api.width - 2 === isNarrow) return false;
  group.api.moveTo({ position: isNarrow ? "top" : "left" });
  return true;
}

/** Gives it the size that it has at first. */
export function sizeMission(api: DockviewApi, isNarrow: boolean): void {
  const size = isNarrow
    ? { height: heightOn(api.height) }
    : { width: Math.min(WIDTH, api.width * WIDTH_SHARE) };
  groupOf(api)?.api.setSize(size);
}

/** The group that contains only mission control. */
function groupOf(api: DockviewApi) {
  const group = api.getPanel(MISSION_PANEL)?.group;
  return group?.api.location.type === "grid" && group.size === 1 ? group : null;
}

function heightOn(page: number): number {
  return Math.max(page * HEIGHT_SHARE, Math.min(HEIGHT_MIN, page - CANVAS_MIN));
}
