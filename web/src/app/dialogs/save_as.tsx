/** Folder for a machine. */

import { useState } from "react";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { type ProjectNode, useProjects } from "../project_tree.tsx";
import type { NamedDialogProps } from "./dialogs.tsx";
import { chosenFolder, FolderChooser } from "./folder_chooser.tsx";

export function SaveAs({ asks, answer }: NamedDialogProps<"save-as">) {
  const nodes = useProjects() ?? [];
  const [name, setName] = useState(asks.name);
  const [place, setPlace] = useState<ProjectNode | null>(null);
  const { file, refusal } = chosenFolder(nodes, place, name);
  const done = () => {
    if (file) answer(file);
  };
  return (
    <Dialog
      title={asks.title}
      width={620}
      height={560}
      onClose={() => answer(null)}
      footer={
        <>
          <Button onClick={() => answer(null)}>Cancel</Button>
          <Button kind="primary" disabled={!file} onClick={done}>
            {asks.yes}
          </Button>
        </>
      }
    >
      <FolderChooser
        name={name}
        onName={setName}
        place={place}
        onPlace={setPlace}
        refusal={nodes.length > 0 ? refusal : null}
        onDone={done}
      />
    </Dialog>
  );
}
