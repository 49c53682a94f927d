/** What the File menu does: machines come from projects, go back there, and are closed. */

import type {
  LibraryName,
  MachineFile,
  MachineSummary,
  SavedState,
} from "../model/generated/protocol.ts";
import { comparisonOf } from "../store/comparison.ts";
import type { OpenTab, Page } from "../store/page.ts";
import type { Link } from "../store/server.ts";
import { RefusalError } from "../store/server.ts";
import { wantedLibrary } from "../store/wanted_library.ts";
import type { Command, Context } from "./command.ts";
import { applyDrafts } from "./drafts.ts";
import { canEdit, libraryAround, mayEdit, onlyState } from "./subject.ts";

const isOpen = (context: Context) => context.tab !== null;

export const FILE: readonly Command[] = [
  {
    id: "file.new",
    title: "New machine…",
    detail: "Makes an empty machine in a project and opens it.",
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
      const file = (argument as MachineFile | undefined) ?? (await shell.dialog("open", undefined));
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
      const file = argument as MachineFile;
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
    title: "Save",
    keys: ["Ctrl+S"],
    menu: "File/2",
    enabled: canEdit,
    run: (context) => saveTab(context, context.tab),
  },
  {
    id: "file.save-as",
    title: "Save as…",
    detail: "Saves the machine in another folder, where it stays from now on.",
    keys: ["Ctrl+Shift+S"],
    menu: "File/2",
    enabled: canEdit,
    run: (context) => saveElsewhere(context, false),
  },
  {
    id: "file.save-copy",
    title: "Save a copy…",
    detail: "Saves the machine in another folder and stays where it lies.",
    keys: ["Ctrl+Shift+Alt+S"],
    menu: "File/2",
    enabled: canEdit,
    run: (context) => saveElsewhere(context, true),
  },
  {
    id: "file.save-state",
    title: "Save state as machine or library…",
    detail: "Saves the selected state with all inside as a machine of its own.",
    keys: ["Ctrl+Alt+S"],
    menu: "File/2",
    enabled: (context) => canEdit(context) && onlyState(context) !== null,
    run: saveState,
  },
  {
    id: "file.save-all",
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
    title: "Save over what lies on disk",
    detail: "Also if another program changed it.",
    enabled: canEdit,
    run: (context) => saveTab(context, context.tab, true),
  },
  {
    id: "file.reload",
    title: "Reload from disk",
    detail: "Makes the machine what lies on disk; an undo brings back what was.",
    classic: ["Shift+F5"],
    menu: "File/3",
    enabled: canEdit,
    run: ({ page, tab }) =>
      tab
        ? page.server.request("POST", `/machines/${tab.room.id}/reload`, { id: requestId() })
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
    id: "file.open-library",
    title: "Open library separately",
    detail:
      "Opens the machine of the selected library state in a tab of its own, if it lies in a project.",
    keys: ["Ctrl+Shift+Space"],
    menu: "File/3",
    enabled: (context) => libraryAround(context) !== null,
    run: openLibrary,
  },
  {
    id: "file.show-library",
    title: "Show in library tree",
    detail: "Selects the library of the selected state in the panel of libraries.",
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
      const tab = (argument as OpenTab | undefined) ?? context.tab;
      if (tab) await closeTab(context, tab);
    },
  },
  {
    id: "file.close-others",
    title: "Close others",
    menu: "File/4",
    enabled: ({ page }) => page.tabs.value.length > 1,
    run: async (context, argument) => {
      const kept = (argument as OpenTab | undefined) ?? context.tab;
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

/** Whether the machine has edits that do not lie on disk. */
export function isChanged(tab: OpenTab): boolean {
  return tab.room.status.value?.summary.is_changed ?? false;
}

function forget(page: Context["page"], file: MachineFile): void {
  const before = page.settings.peek();
  const recent = before.recent.filter((each) => !isSame(each, file));
  page.settings.value = { ...before, recent };
}

function isSame(one: MachineFile, other: MachineFile): boolean {
  return one.project === other.project && one.path === other.path;
}

/** An id for a request, as the server wants one with whatever changes something. */
export function requestId(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(12));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** Saves where the machine lies. What another program changed meanwhile is never lost without a word. */
export async function saveTab(
  context: Context,
  tab: OpenTab | null,
  overwrite = false,
): Promise<boolean> {
  if (!tab) return false;
  if (tab.room.status.peek()?.summary.file === null) return saveElsewhere(context, false);
  const { page, shell } = context;
  if (!(await applyDrafts(page, tab))) return false;
  try {
    await page.server.request("POST", `/machines/${tab.room.id}/save`, { overwrite });
    return true;
  } catch (error) {
    if (!(error instanceof RefusalError) || error.code !== "changed_on_disk") throw error;
  }
  const choice = await shell.choose({
    title: "The files were changed by another program",
    text: "Somebody changed this machine on disk since it was read: a git pull, perhaps, or another editor.",
    choices: [
      { value: "compare", title: "Compare first", detail: "Shows both side by side." },
      {
        value: "theirs",
        title: "Take what lies on disk",
        detail: "An undo brings back what is here.",
      },
      { value: "mine", title: "Save mine over it", detail: "What lies on disk is replaced." },
    ],
  });
  if (choice === "compare") await compare(context);
  if (choice === "theirs") {
    await page.server.request("POST", `/machines/${tab.room.id}/reload`, { id: requestId() });
  }
  return choice === "mine" ? saveTab(context, tab, true) : false;
}

/** Compares with what lies on disk, unless something else was chosen already. */
async function compare({ page, tab, shell }: Context): Promise<void> {
  shell.showPanel("differences");
  if (!tab) return;
  const comparison = comparisonOf(tab, page.server);
  if (comparison.against.peek() === null) await comparison.choose({ kind: "saved" });
}

async function saveElsewhere(context: Context, copy: boolean): Promise<boolean> {
  const { page, tab, shell } = context;
  if (!tab || !(await applyDrafts(page, tab))) return false;
  const file = await shell.dialog("save-as", {
    title: copy ? "Save a copy" : "Save as",
    name: folderName(tab.room.machine.state(tab.room.machine.root)?.name ?? "machine"),
    yes: copy ? "Save copy" : "Save",
  });
  if (!file) return false;
  await page.server.request("POST", `/machines/${tab.room.id}/save`, { file, copy });
  if (copy) {
    page.tell({
      level: "info",
      text: `A copy lies in ${file.path}.`,
      action: { title: "Open it", command: "file.open", argument: file },
    });
  }
  return true;
}

async function saveState(context: Context): Promise<void> {
  const { page, tab, shell } = context;
  const path = onlyState(context);
  if (!tab || path === null) return;
  const name = tab.room.machine.state(path)?.name ?? "state";
  const file = await shell.dialog("save-as", {
    title: `Save “${name}” as a machine or library`,
    name: folderName(name),
    yes: "Save",
  });
  if (!file) return;
  const saved = await page.server.request<SavedState>(
    "POST",
    `/machines/${tab.room.id}/save_state`,
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

async function openLibrary(context: Context): Promise<void> {
  const library = libraryAround(context)?.library;
  if (library) await openLibraryMachine(context.page, library);
}

/** Shows which of all libraries a state runs; the user is told if it is not among them. */
function showLibrary(context: Context): void {
  const library = libraryAround(context)?.library;
  if (!library) return;
  const { path, name } = library;
  const [rootName = "", ...folders] = path.split("/");
  let nodes = context.page.libraries.peek().find((root) => root.name === rootName)?.children;
  for (const folder of folders) nodes = nodes?.find((node) => node.name === folder)?.children;
  if (!nodes?.some((node) => node.kind === "library" && node.name === name)) {
    const text = `${path}/${name} is in none of the library roots: put it back, or name its root under LIBRARY_PATHS in config.yaml.`;
    context.page.tell({ level: "warning", text });
    return;
  }
  wantedLibrary.value = { path, name };
  context.shell.showPanel("libraries");
}

/** Opens the machine of a library in a tab of its own, if it lies in a project; the user is told if it does not. */
export async function openLibraryMachine(page: Page, library: LibraryName): Promise<void> {
  const [rootName = "", ...folders] = library.path.split("/");
  const root = page.libraries.peek().find((each) => each.name === rootName);
  const place = root && [root.folder, ...folders, library.name].join("/");
  const project = page.projects.peek().find((each) => place?.startsWith(`${each.folder}/`));
  if (!place || !project) {
    page.tell({
      level: "warning",
      text: `${library.path}/${library.name} lies in none of the projects that the server was started with: start it with that folder too to edit the library.`,
    });
    return;
  }
  const file = { project: project.id, path: place.slice(project.folder.length + 1) };
  await page.open(file);
}

/** Closes the tab; what is not saved is asked for. True if it is closed. */
async function closeTab(context: Context, tab: OpenTab): Promise<boolean> {
  const { page, shell } = context;
  const others = tab.room.people.peek().length > 0;
  if (!isChanged(tab) || others || !mayEdit(page)) {
    if (!isChanged(tab) && !others) await closeOnServer(context, tab, false);
    page.leave(tab);
    return true;
  }
  const name = tab.room.machine.state(tab.room.machine.root)?.name ?? "this machine";
  const choice = await shell.choose({
    title: `Save “${name}” before it is closed?`,
    text: "It has edits that do not lie on disk.",
    choices: [
      { value: "save", title: "Save and close" },
      {
        value: "keep",
        title: "Close and keep the edits",
        detail: "The server keeps them; they are back when the machine is opened again.",
      },
      {
        value: "discard",
        title: "Close and give up the edits",
        detail: "They cannot be had back.",
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
async function closeOnServer({ page }: Context, tab: OpenTab, discard: boolean): Promise<void> {
  if (!mayEdit(page)) return;
  await page.server.request("POST", `/machines/${tab.room.id}/close`, { discard });
}
