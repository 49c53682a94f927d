/** Initial layout of the panels: mission control for operators, the editor for everybody else, or the layout of the address
 * (`?layout=mission`). */

import { MISSION_LAYOUT } from "../commands/mission.ts";
import type { Page } from "../store/page/page.ts";
import { sessionOfPage } from "../store/run/running.ts";

export function initialLayout(page: Page): string {
  return sessionOfPage(page)?.role === "operator" ? MISSION_LAYOUT : "Edit";
}

/** Layout requested by the address. It is removed there, so a reload restores the last layout. */
export function takeAsked(view: Pick<Window, "location" | "history">): {
  readonly isMission: boolean;
  readonly run: string | null;
} {
  const url = new URL(view.location.href);
  const [layout, run] = [url.searchParams.get("layout"), url.searchParams.get("run")];
  if (layout === null && run === null) return { isMission: false, run: null };
  url.searchParams.delete("layout");
  url.searchParams.delete("run");
  view.history.replaceState(view.history.state, "", url);
  return { isMission: layout === "mission", run };
}
