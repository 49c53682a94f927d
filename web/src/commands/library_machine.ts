/** From a library state to its library: as a machine of its own, and in the panel of libraries. */

import type { LibraryName } from "../model/generated/protocol.ts";
import type { Page } from "../store/page/page.ts";
import { libraryRevealRequest } from "../store/page/reveal_requests.ts";
import type { CommandContext } from "./command.ts";
import { libraryAround } from "./subject.ts";

/** Opens the machine of the library that is selected. */
export async function openLibrary(context: CommandContext): Promise<void> {
  const library = libraryAround(context)?.library;
  if (library) await openLibraryMachine(context.page, library);
}

/** Selects the library of a state in the list of libraries; reports a library that is not listed. */
export function showLibrary(context: CommandContext): void {
  const library = libraryAround(context)?.library;
  if (!library) return;
  const { path, name } = library;
  const [rootName = "", ...folders] = path.split("/");
  let nodes = context.page.libraries.peek().find((root) => root.name === rootName)?.children;
  for (const folder of folders) nodes = nodes?.find((node) => node.name === folder)?.children;
  if (!nodes?.some((node) => node.kind === "library" && node.name === name)) {
    const text = `${path}/${name} is not in any library root. Put it back, or add its root to LIBRARY_PATHS in config.yaml.`;
    context.page.tell({ level: "warning", text });
    return;
  }
  libraryRevealRequest.value = { path, name };
  context.shell.showPanel("libraries");
}

/** Opens the machine of a library in a tab if it is in a project; reports it otherwise. */
export async function openLibraryMachine(page: Page, library: LibraryName): Promise<void> {
  const [rootName = "", ...folders] = library.path.split("/");
  const root = page.libraries.peek().find((each) => each.name === rootName);
  const place = root && [root.folder, ...folders, library.name].join("/");
  const project = page.projects.peek().find((each) => place?.startsWith(`${each.folder}/`));
  if (!place || !project) {
    page.tell({
      level: "warning",
      text: `${library.path}/${library.name} is not in any of the server's projects. To edit the library, start the server with that folder as well.`,
    });
    return;
  }
  const file = { project: project.id, path: place.slice(project.folder.length + 1) };
  await page.open(file);
}
