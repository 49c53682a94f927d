/** Closes tabs. Unsaved edits are never discarded without a question. */

import type { OpenTab } from "../store/page/page.ts";
import { mayEdit } from "../store/page/rights.ts";
import type { CommandContext } from "./command.ts";
import { isChanged, saveTab } from "./save.ts";

/** Closes the tab; what is not saved is asked for. True if it is closed. */
export async function closeTab(context: CommandContext, tab: OpenTab): Promise<boolean> {
  const { page, shell } = context;
  const others = tab.session.people.peek().length > 0;
  if (!isChanged(tab) || others || !mayEdit(page)) {
    if (!isChanged(tab) && !others) await closeOnServer(context, tab, false);
    page.leave(tab);
    return true;
  }
  const name = tab.session.machine.state(tab.session.machine.root)?.name ?? "this machine";
  const choice = await shell.choose({
    title: `Save “${name}” before closing?`,
    text: "It has unsaved edits.",
    safe: "save",
    choices: [
      { value: "save", title: "Save and close" },
      {
        value: "keep",
        title: "Close and keep edits",
        detail: "The server keeps them and restores them when you open the machine again.",
      },
      {
        value: "discard",
        title: "Close and discard edits",
        detail: "They cannot be restored.",
      },
    ],
  });
  if (choice === null) return false;
  if (choice === "save" && !(await saveTab(context, tab))) return false;
  if (choice !== "keep") await closeOnServer(context, tab, choice === "discard");
  page.leave(tab);
  return true;
}

/** Others may have the machine open: then it stays on the server. */
async function closeOnServer(
  { page }: CommandContext,
  tab: OpenTab,
  discard: boolean,
): Promise<void> {
  if (!mayEdit(page)) return;
  await page.server.request("POST", `/machines/${tab.session.id}/close`, { discard });
}
