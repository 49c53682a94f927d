/** Menu of a library: add it, open it, substitute it for the selected state, or find its uses. */

import { libraryMachine } from "../../commands/insert.ts";
import { openLibraryMachine } from "../../commands/library_machine.ts";
import { performIn } from "../../commands/perform.ts";
import { canEdit, onlyState } from "../../commands/subject.ts";
import type { LibraryName, StateDocument } from "../../model/generated/protocol.ts";
import { idOf, parentOf } from "../../model/path.ts";
import { boxIn } from "../../plan/boxes.ts";
import { substitute } from "../../plan/group.ts";
import { libraryState } from "../../plan/newcomers.ts";
import type { MenuItem } from "../../ui/menu.tsx";
import type { PanelHost } from "../context.tsx";

export function libraryMenu(
  host: PanelHost,
  library: LibraryName,
  showUsages: (library: LibraryName) => void,
): readonly MenuItem[] {
  const context = host.context();
  const { page } = context;
  const can = (id: "insert.library" | "insert.template") =>
    host.commands.get(id)?.enabled?.(context) !== false;
  const insert = (id: "insert.library" | "insert.template") => () =>
    void host.commands.run(id, context, library);
  return [
    {
      id: "add",
      title: "Add as library",
      detail: "A state that runs the library.",
      disabled: !can("insert.library"),
      run: insert("insert.library"),
    },
    {
      id: "copy",
      title: "Add as copy",
      detail: "Its states become editable states of this machine.",
      disabled: !can("insert.template"),
      run: insert("insert.template"),
    },
    {
      id: "substitute",
      title: "Substitute selected state",
      disabled: !canEdit(context) || !isInner(onlyState(context)),
      items: [
        by("as-library-keep", "With the library, keep the state's name", false, true),
        by("as-library-take", "With the library, use the library's name", false, false),
        by("as-copy-keep", "With a copy, keep the state's name", true, true),
        by("as-copy-take", "With a copy, use the library's name", true, false),
      ],
    },
    "separator",
    {
      id: "open",
      title: "Open",
      detail: "Opens in its own tab if it is in a project.",
      run: () => void openLibraryMachine(page, library),
    },
    { id: "usages", title: "Show where it is used", run: () => showUsages(library) },
  ];

  function by(id: string, title: string, copy: boolean, keepName: boolean): MenuItem {
    return { id, title, run: () => void putInPlace(host, library, copy, keepName) };
  }
}

function isInner(path: string | null): boolean {
  return path !== null && parentOf(path) !== null;
}

async function putInPlace(
  host: PanelHost,
  library: LibraryName,
  copy: boolean,
  keepName: boolean,
): Promise<void> {
  const context = host.context();
  const { page, tab } = context;
  const path = onlyState(context);
  if (!tab || path === null) return;
  try {
    const { states, version } = await libraryMachine(context, library);
    const { machine } = tab.session;
    const comers = copy
      ? states
      : asLibrary(states, path, { ...library, version }, boxIn(machine, path));
    await performIn(page, tab, substitute(machine, path, comers, keepName));
  } catch (error) {
    page.tell({ level: "error", text: error instanceof Error ? error.message : String(error) });
  }
}

function asLibrary(
  [root]: readonly StateDocument[],
  path: string,
  library: Parameters<typeof libraryState>[2],
  box: Parameters<typeof libraryState>[4],
): readonly StateDocument[] {
  return root ? [libraryState(idOf(path), root.name, library, root, box)] : [];
}
