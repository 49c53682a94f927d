/** Whether the user of this page may edit, and why not. One rule for menus, keys, panels and the canvas. */

import type { OpenTab, Page } from "./page.ts";

const MAY_ONLY_LOOK =
  "You can view this machine but not edit it. Ask an admin for the role engineer.";

/** Whether the session may edit. While the server cannot be asked, what is done waits for it. */
export function mayEdit({ server }: { readonly server: Pick<Page["server"], "link"> }): boolean {
  const link = server.link.value;
  return link.state !== "up" || link.session.rights.includes("edit");
}

/** Why nothing of a machine can be edited; null if it can be. */
export function whyFixed(page: Page, tab: OpenTab): string | null {
  return mayEdit(page) ? tab.session.fixed : MAY_ONLY_LOOK;
}
