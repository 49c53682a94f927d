/** Which machine is to be opened: from all projects, found by typing. */

import { useState } from "react";
import type { MachineFile } from "../../model/generated/protocol.ts";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { filtered, type ProjectNode, ProjectTree, useProjects } from "../project_tree.tsx";
import { useSession } from "../session_context.tsx";
import type { NamedDialogProps } from "./dialogs.tsx";
import { keysAboveTree } from "./tree_below.ts";

export function OpenMachine({ answer }: NamedDialogProps<"open">) {
  const nodes = useProjects();
  const [search, setSearch] = useState("");
  const [chosen, setChosen] = useState<ProjectNode | null>(null);
  const first = firstMachine(nodes ?? [], search);
  const shown = chosen?.file ?? first;
  const machine = chosen === null || chosen.kind === "machine" ? shown : null;
  return (
    <Dialog
      title="Open a machine"
      width={620}
      height={560}
      onClose={() => answer(null)}
      footer={
        <>
          <Button onClick={() => answer(null)}>Cancel</Button>
          <Button kind="primary" disabled={!machine} onClick={() => answer(machine)}>
            Open
          </Button>
        </>
      }
    >
      <div className="form">
        <TextField
          label="Find"
          hideLabel
          type="search"
          placeholder="Find a machine"
          value={search}
          onInput={(text) => {
            setSearch(text);
            setChosen(null);
          }}
          autoFocus
          onKeyDown={(event) => keysAboveTree(event, () => machine && answer(machine))}
        />
        <div className="form-tree">
          {nodes && (
            <ProjectTree
              nodes={nodes}
              search={search}
              selected={shown}
              first={first}
              onSelect={setChosen}
              onOpen={(node) => node.kind === "machine" && answer(node.file)}
            />
          )}
        </div>
        {search === "" && <Recent onTake={answer} />}
      </div>
    </Dialog>
  );
}

const RECENT_SHOWN = 5;

/** Machines that were open lately. */
function Recent({ onTake }: { onTake: (file: MachineFile) => void }) {
  const { page } = useSession();
  const { recent } = useSignal(page.settings);
  if (recent.length === 0) return null;
  return (
    <section className="form-recent" aria-label="Recent">
      <span>Recent</span>
      {recent.slice(0, RECENT_SHOWN).map((file) => (
        <Button
          key={`${file.project}/${file.path}`}
          title={`${file.project} / ${file.path}`}
          onClick={() => onTake(file)}
        >
          {file.path.split("/").at(-1)}
        </Button>
      ))}
    </section>
  );
}

/** The machine that is found first: Enter opens it. */
function firstMachine(nodes: readonly ProjectNode[], search: string): MachineFile | null {
  const machines = (list: readonly ProjectNode[]): ProjectNode[] =>
    list.flatMap((node) => (node.kind === "machine" ? [node] : machines(node.children ?? [])));
  const [first] = machines(search.trim() === "" ? [] : filtered(nodes, search));
  return first?.file ?? null;
}
