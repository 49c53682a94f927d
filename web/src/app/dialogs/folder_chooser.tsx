/** Chooser of a folder for a machine: an existing one, with the name of a new folder or path in it. */

import { useState } from "react";
import type { LibraryRoot, MachineFile, Project } from "../../model/generated/protocol.ts";
import { TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { type ProjectNode, ProjectTree, useProjects } from "../project_tree.tsx";
import { useSession } from "../session_context.tsx";
import { keysAboveTree } from "./tree_below.ts";

interface ChosenFolder {
  readonly file: MachineFile | null;
  /** Reason why the folder cannot be used. */
  readonly refusal: string | null;
}

/** The chosen path. Folders of machines contain nothing else. */
export function chosenFolder(
  nodes: readonly ProjectNode[],
  place: ProjectNode | null,
  name: string,
): ChosenFolder {
  const parent = place ?? nodes[0] ?? null;
  if (!parent) return refused("There is no project to save to.");
  if (name.trim() === "") return refused("The folder needs a name.");
  const names = name.split("/").map((part) => part.trim());
  if (!names.every(isName)) {
    return refused(
      "Enter a folder name, or several separated by slashes. A name must not start with a dot or contain backslashes.",
    );
  }
  let around = parent;
  for (const part of names) {
    if (around.kind === "machine") {
      return refused(
        `${around.name} is a machine and cannot contain other machines. Choose a folder next to it.`,
      );
    }
    const there = around.children?.find((child) => child.name === part);
    if (!there) {
      const { project, path } = parent.file;
      return { file: { project, path: joined(path, names) }, refusal: null };
    }
    around = there;
  }
  return refused(
    `${parent.name} already contains a ${around.kind} ${around.name}. Choose another name.`,
  );
}

function refused(refusal: string): ChosenFolder {
  return { file: null, refusal };
}

function isName(name: string): boolean {
  return name !== "" && !name.startsWith(".") && !name.includes("\\");
}

function joined(path: string, names: readonly string[]): string {
  return [...(path === "" ? [] : [path]), ...names].join("/");
}

/** The library path of a folder; null if it lies below no library root. */
export function libraryOf(
  projects: readonly Project[],
  roots: readonly LibraryRoot[],
  { project, path }: MachineFile,
): string | null {
  const home = projects.find((each) => each.id === project)?.folder;
  const folder = path === "" ? home : `${home}/${path}`;
  for (const root of roots) {
    if (folder === root.folder) return root.name;
    if (folder?.startsWith(`${root.folder}/`)) return root.name + folder.slice(root.folder.length);
  }
  return null;
}

/** Path of the folder, and its library path. */
export function placeInWords(
  projects: readonly Project[],
  roots: readonly LibraryRoot[],
  file: MachineFile,
): string {
  const project = projects.find((each) => each.id === file.project)?.name ?? file.project;
  const library = libraryOf(projects, roots, file);
  const place = [project, ...file.path.split("/")].join(" / ");
  return `Location: ${place}${library === null ? "" : `, as the library ${library}`}.`;
}

interface FolderChooserProps {
  readonly name: string;
  readonly onName: (name: string) => void;
  readonly place: ProjectNode | null;
  readonly onPlace: (place: ProjectNode) => void;
  readonly refusal: string | null;
  readonly onDone: () => void;
  /** True if the name has the initial focus. */
  readonly autoFocus?: boolean;
}

export function FolderChooser(props: FolderChooserProps) {
  const { page } = useSession();
  const nodes = useProjects();
  const projects = useSignal(page.projects);
  const roots = useSignal(page.libraries);
  const [search, setSearch] = useState("");
  const { file } = chosenFolder(nodes ?? [], props.place, props.name);
  const libraryRoot = (node: ProjectNode) =>
    roots.some(({ name }) => name === libraryOf(projects, roots, node.file));
  return (
    <div className="form">
      <TextField
        label="Folder name"
        value={props.name}
        onInput={props.onName}
        autoFocus={props.autoFocus ?? true}
        refusal={props.refusal}
        hint={file ? placeInWords(projects, roots, file) : undefined}
        onKeyDown={(event) => event.key === "Enter" && props.onDone()}
      />
      <TextField
        label="Find a folder"
        hideLabel
        type="search"
        placeholder="Find a folder"
        value={search}
        onInput={setSearch}
        onKeyDown={(event) => keysAboveTree(event, () => {})}
      />
      <div className="form-tree">
        {nodes && (
          <ProjectTree
            nodes={nodes}
            search={search}
            selected={(props.place ?? nodes[0])?.file ?? null}
            onSelect={props.onPlace}
            onOpen={props.onPlace}
            note={(node) => (libraryRoot(node) ? "library root" : null)}
          />
        )}
      </div>
    </div>
  );
}
