/** How the panels stand when nobody has put them anywhere yet: an operator comes to mission control, everybody else to the editor;
 * and what the address asks for: `?layout=mission`. */

import { MISSION_LAYOUT } from "../commands/mission.ts";
import type { Page } from "../store/page/page.ts";
import { sessionOfPage } from "../store/run/running.ts";

export function initialLayout(page: Page): string {
  return sessionOfPage(page)?.role === "operator" ? MISSION_LAYOUT : "Edit";
}

/** What the address asks for, taken out of it: a page that is loaded again comes back as it was left. */
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
