/** Saves machines and states: in place, elsewhere, as copies, as libraries. */

import type { SavedState } from "../model/generated/protocol.ts";
import { comparisonOf } from "../store/page/comparison.ts";
import type { OpenTab, Page } from "../store/page/page.ts";
import { RefusalError } from "../store/page/server.ts";
import type { CommandContext } from "./command.ts";
import { applyDrafts } from "./drafts.ts";
import { onlyState } from "./subject.ts";

/** True if the machine has unsaved edits. */
export function isChanged(tab: OpenTab): boolean {
  return tab.session.status.value?.summary.is_changed ?? false;
}

/** A new id for a request that changes something. */
export function requestId(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(12));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** Makes edits of what the page has and the machine has not: drafts, and the layout that is shown for a machine without one. */
async function finishEdits(page: Page, tab: OpenTab): Promise<boolean> {
  await tab.session.proposal?.keep();
  return applyDrafts(page, tab);
}

/** Saves where the machine lies. What another program changed meanwhile is never lost without a word. */
export async function saveTab(
  context: CommandContext,
  tab: OpenTab | null,
  overwrite = false,
): Promise<boolean> {
  if (!tab) return false;
  if (tab.session.status.peek()?.summary.file === null) return saveElsewhere(context, false);
  const { page, shell } = context;
  if (!(await finishEdits(page, tab))) return false;
  try {
    await page.server.request("POST", `/machines/${tab.session.id}/save`, { overwrite });
    return true;
  } catch (error) {
    if (!(error instanceof RefusalError) || error.code !== "changed_on_disk") throw error;
  }
  const choice = await shell.choose({
    title: "Another program changed the files",
    text: "This machine changed on disk after it was read, for example through a git pull or another editor.",
    safe: "compare",
    choices: [
      { value: "compare", title: "Compare first", detail: "Shows both side by side." },
      {
        value: "theirs",
        title: "Load the version on disk",
        detail: "You can undo this.",
      },
      { value: "mine", title: "Overwrite with mine", detail: "Replaces the version on disk." },
    ],
  });
  if (choice === "compare") await compare(context);
  if (choice === "theirs") {
    await page.server.request("POST", `/machines/${tab.session.id}/reload`, { id: requestId() });
  }
  return choice === "mine" ? saveTab(context, tab, true) : false;
}

/** Compares with what lies on disk, unless something else was chosen already. */
export async function compare({ page, tab, shell }: CommandContext): Promise<void> {
  shell.showPanel("differences");
  if (!tab) return;
  const comparison = comparisonOf(tab, page.server);
  if (comparison.against.peek() === null) await comparison.choose({ kind: "saved" });
}

/** Saves in a folder that the user chooses: the machine itself, or a copy of it. */
export async function saveElsewhere(context: CommandContext, copy: boolean): Promise<boolean> {
  const { page, tab, shell } = context;
  if (!tab || !(await finishEdits(page, tab))) return false;
  const file = await shell.dialog("save-as", {
    title: copy ? "Save a copy" : "Save as",
    name: folderName(tab.session.machine.state(tab.session.machine.root)?.name ?? "machine"),
    yes: copy ? "Save copy" : "Save",
  });
  if (!file) return false;
  await page.server.request("POST", `/machines/${tab.session.id}/save`, { file, copy });
  if (copy) {
    page.tell({
      level: "info",
      text: `A copy was saved in ${file.path}.`,
      action: { title: "Open it", command: "file.open", argument: file },
    });
  }
  return true;
}

/** Saves the selected state and its content as a separate machine. */
export async function saveState(context: CommandContext): Promise<void> {
  const { page, tab, shell } = context;
  const path = onlyState(context);
  if (!tab || path === null) return;
  const name = tab.session.machine.state(path)?.name ?? "state";
  const file = await shell.dialog("save-as", {
    title: `Save “${name}” as a machine or library`,
    name: folderName(name),
    yes: "Save",
  });
  if (!file) return;
  const saved = await page.server.request<SavedState>(
    "POST",
    `/machines/${tab.session.id}/save_state`,
    { path, file },
  );
  const what = saved.library ? `library ${saved.library.path}/${saved.library.name}` : "machine";
  page.tell({
    level: "info",
    text: `“${name}” is saved as the ${what} in ${file.path}.`,
    action: saved.library
      ? {
          title: "Use it here",
          command: "arrange.substitute",
          argument: { path, library: saved.library },
        }
      : { title: "Open it", command: "file.open", argument: saved.file },
  });
}

/** A folder's name from a state's: what every file system takes. */
export function folderName(name: string): string {
  const plain = name
    .trim()
    .replace(/[^\p{L}\p{N}._-]+/gu, "_")
    .replace(/^[._]+|[_.]+$/g, "");
  return plain === "" ? "machine" : plain.toLowerCase();
}
