/** Editing rights of the user, and the reason if they are missing. Menus, keys, panels and the canvas share this rule. */

import type { OpenTab, Page } from "./page.ts";

const MAY_ONLY_LOOK =
  "You can view this machine but not edit it. Ask an admin for the role engineer.";

/** True if the session may edit. Also true without a connection: edits wait until it is back. */
export function mayEdit({ server }: { readonly server: Pick<Page["server"], "link"> }): boolean {
  const link = server.link.value;
  return link.state !== "up" || link.session.rights.includes("edit");
}

/** Reason why a machine cannot be edited; null if it can. */
export function whyFixed(
  page: { readonly server: Pick<Page["server"], "link"> },
  tab: { readonly session: Pick<OpenTab["session"], "fixed"> },
): string | null {
  return mayEdit(page) ? tab.session.fixed : MAY_ONLY_LOOK;
}
