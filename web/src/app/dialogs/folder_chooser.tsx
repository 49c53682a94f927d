/** A folder for a machine: one that is there, with a name for a new one in it. */

import { useState } from "react";
import type { MachineFile } from "../../model/generated/protocol.ts";
import { TextField } from "../../ui/field.tsx";
import { type ProjectNode, ProjectTree, useProjects } from "../project_tree.tsx";

export interface Chosen {
  readonly file: MachineFile | null;
  /** Why it cannot be that one. */
  readonly refusal: string | null;
}

/** What is chosen by a folder and a name in it. Machines are folders that hold nothing else. */
export function chosenFolder(
  nodes: readonly ProjectNode[],
  place: ProjectNode | null,
  name: string,
): Chosen {
  const text = name.trim();
  const parent = place ?? nodes[0] ?? null;
  if (!parent) return { file: null, refusal: "There is no project to save in." };
  if (text === "") return { file: null, refusal: "The folder needs a name." };
  if (/[/\\]/.test(text) || text === "." || text === "..") {
    return { file: null, refusal: "The name of a folder has no slashes: choose the place above." };
  }
  if (parent.kind === "machine") {
    return {
      file: null,
      refusal: `${parent.name} is a machine, and a machine holds no others: choose a folder beside it.`,
    };
  }
  const there = parent.children?.find((child) => child.name === text);
  if (there) {
    return {
      file: null,
      refusal: `There is a ${there.kind} ${text} in ${parent.name} already: choose another name.`,
    };
  }
  const { project, path } = parent.file;
  return { file: { project, path: path === "" ? text : `${path}/${text}` }, refusal: null };
}

export interface FolderChooserProps {
  readonly name: string;
  readonly onName: (name: string) => void;
  readonly place: ProjectNode | null;
  readonly onPlace: (place: ProjectNode) => void;
  readonly refusal: string | null;
  readonly onDone: () => void;
  /** Whether the name has the keyboard at first. */
  readonly autoFocus?: boolean;
}

export function FolderChooser(props: FolderChooserProps) {
  const nodes = useProjects();
  const [search, setSearch] = useState("");
  return (
    <div className="form">
      <TextField
        label="Folder name"
        value={props.name}
        onInput={props.onName}
        autoFocus={props.autoFocus ?? true}
        refusal={props.refusal}
        hint={placeHint(props.place ?? nodes?.[0] ?? null)}
        onKeyDown={(event) => event.key === "Enter" && props.onDone()}
      />
      <TextField
        label="Find a folder"
        hideLabel
        type="search"
        placeholder="Find a folder"
        value={search}
        onInput={setSearch}
      />
      <div className="form-tree">
        {nodes && (
          <ProjectTree
            nodes={nodes}
            search={search}
            selected={(props.place ?? nodes[0])?.file ?? null}
            onSelect={props.onPlace}
            onOpen={props.onPlace}
          />
        )}
      </div>
    </div>
  );
}

function placeHint(place: ProjectNode | null): string | undefined {
  if (!place) return undefined;
  const { file, name, kind } = place;
  return `It will lie in ${kind === "project" ? name : `${file.project} / ${file.path}`}.`;
}
