/** Commands of the File menu: open, save and close machines. */

import type { MachineFile, MachineSummary } from "../model/generated/protocol.ts";
import { mayEdit } from "../store/page/rights.ts";
import type { Link } from "../store/page/server.ts";
import { RefusalError } from "../store/page/server.ts";
import { closeTab } from "./close.ts";
import type { CommandContext, UserCommand } from "./command.ts";
import { openLibrary, showLibrary } from "./library_machine.ts";
import { compare, isChanged, requestId, saveElsewhere, saveState, saveTab } from "./save.ts";
import { canEdit, libraryAround, onlyState } from "./subject.ts";

const isOpen = (context: CommandContext) => context.tab !== null;

export const FILE: readonly UserCommand[] = [
  {
    id: "file.new",
    title: "New machine…",
    detail: "Creates an empty machine in a project and opens it.",
    keys: ["Ctrl+Alt+N"],
    classic: ["Ctrl+N", "Ctrl+Shift+Alt+N"],
    menu: "File/1",
    enabled: ({ page }) => mayEdit(page),
    run: async ({ page, shell }) => {
      const wanted = await shell.dialog("new", undefined);
      if (!wanted) return;
      const made = await page.server.request<MachineSummary>("POST", "/machines", wanted);
      await page.join(made.id);
    },
  },
  {
    id: "file.open",
    title: "Open…",
    keys: ["Ctrl+O"],
    menu: "File/1",
    run: async ({ page, shell }, argument) => {
      const file = argument ?? (await shell.dialog("open", undefined));
      if (!file) return;
      await page.open(file);
    },
  },
  {
    id: "file.recent",
    title: "Open recent",
    menu: "File/1",
    enabled: ({ page }) => page.settings.value.recent.length > 0,
    choices: ({ page }) =>
      page.settings.value.recent.map((file) => ({
        title: file.path.split("/").at(-1) ?? file.path,
        detail: `${file.project}/${file.path}`,
        argument: file,
      })),
    run: async ({ page }, argument) => {
      const file = argument;
      if (!file) return;
      try {
        await page.open(file);
      } catch (error) {
        if (error instanceof RefusalError && error.status === 404) forget(page, file);
        throw error;
      }
    },
  },
  {
    id: "file.save",
    edits: true,
    title: "Save",
    keys: ["Ctrl+S"],
    menu: "File/2",
    enabled: canEdit,
    run: (context) => saveTab(context, context.tab),
  },
  {
    id: "file.save-as",
    edits: true,
    title: "Save as…",
    detail: "Saves the machine in another folder and continues there.",
    keys: ["Ctrl+Shift+S"],
    menu: "File/2",
    enabled: canEdit,
    run: (context) => saveElsewhere(context, false),
  },
  {
    id: "file.save-copy",
    edits: true,
    title: "Save a copy…",
    detail: "Saves the machine in another folder and continues here.",
    keys: ["Ctrl+Shift+Alt+S"],
    menu: "File/2",
    enabled: canEdit,
    run: (context) => saveElsewhere(context, true),
  },
  {
    id: "file.save-state",
    edits: true,
    title: "Save state as machine or library…",
    detail: "Saves the selected state and its content as a separate machine.",
    keys: ["Ctrl+Alt+S"],
    menu: "File/2",
    needs: "select one state first",
    enabled: (context) => canEdit(context) && onlyState(context) !== null,
    run: saveState,
  },
  {
    id: "file.save-all",
    edits: true,
    title: "Save all",
    menu: "File/2",
    enabled: ({ page }) => mayEdit(page) && page.tabs.value.some(isChanged),
    run: async (context) => {
      for (const tab of context.page.tabs.peek()) {
        if (isChanged(tab)) await saveTab(context, tab);
      }
    },
  },
  {
    id: "file.overwrite",
    title: "Overwrite the files on disk",
    detail: "Even if another program changed them.",
    enabled: canEdit,
    run: (context) => saveTab(context, context.tab, true),
  },
  {
    id: "file.reload",
    title: "Reload from disk",
    detail: "Replaces the machine with its files on disk. You can undo this.",
    classic: ["Shift+F5"],
    menu: "File/3",
    enabled: canEdit,
    run: ({ page, tab }) =>
      tab
        ? page.server.request("POST", `/machines/${tab.session.id}/reload`, { id: requestId() })
        : undefined,
  },
  {
    id: "file.compare",
    title: "Compare with disk or an earlier version…",
    menu: "File/3",
    enabled: isOpen,
    run: compare,
  },
  {
    id: "file.set-aside",
    title: "Edits set aside…",
    detail: "Lists unsaved edits that the server could not restore.",
    menu: "File/3",
    enabled: ({ tab }) => (tab?.session.status.value?.summary.set_aside ?? 0) > 0,
    run: async ({ tab, shell }) => {
      if (tab) await shell.dialog("set-aside", tab);
    },
  },
  {
    id: "file.open-library",
    title: "Open library separately",
    detail:
      "Opens the machine of the selected library state in its own tab, if it is in a project.",
    keys: ["Ctrl+Shift+Space"],
    menu: "File/3",
    needs: "select a library state first",
    enabled: (context) => libraryAround(context) !== null,
    run: openLibrary,
  },
  {
    id: "file.show-library",
    title: "Show in library tree",
    detail: "Selects the library of the selected state in the Libraries panel.",
    menu: "File/3",
    enabled: (context) => libraryAround(context) !== null,
    run: showLibrary,
  },
  {
    id: "file.close",
    title: "Close",
    keys: ["Ctrl+Alt+W"],
    classic: ["Ctrl+W", "Ctrl+Alt+W"],
    menu: "File/4",
    enabled: isOpen,
    run: async (context, argument) => {
      const tab = argument ?? context.tab;
      if (tab) await closeTab(context, tab);
    },
  },
  {
    id: "file.close-others",
    title: "Close others",
    menu: "File/4",
    enabled: ({ page }) => page.tabs.value.length > 1,
    run: async (context, argument) => {
      const kept = argument ?? context.tab;
      for (const tab of context.page.tabs.peek()) {
        if (tab !== kept && !(await closeTab(context, tab))) return;
      }
    },
  },
  {
    id: "file.close-all",
    title: "Close all",
    menu: "File/4",
    enabled: ({ page }) => page.tabs.value.length > 0,
    run: async (context) => {
      for (const tab of context.page.tabs.peek()) if (!(await closeTab(context, tab))) return;
    },
  },
  {
    id: "file.log-out",
    title: "Log out",
    menu: "File/5",
    enabled: ({ page }) => isLoggedIn(page.server.link.value),
    run: async ({ page }) => {
      await page.server.request("DELETE", "/session");
      page.server.retry();
    },
  },
];

function isLoggedIn(link: Link): boolean {
  return link.state === "up" && link.session.expires_ms !== null;
}

function forget(page: CommandContext["page"], file: MachineFile): void {
  const before = page.settings.peek();
  const recent = before.recent.filter((each) => !isSame(each, file));
  page.settings.value = { ...before, recent };
}

function isSame(one: MachineFile, other: MachineFile): boolean {
  return one.project === other.project && one.path === other.path;
}
