/** Name and folder of a new machine. */

import { useState } from "react";
import { folderName } from "../../commands/save.ts";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { TextField } from "../../ui/field.tsx";
import { type ProjectNode, useProjects } from "../project_tree.tsx";
import type { NamedDialogProps } from "./dialogs.tsx";
import { chosenFolder, FolderChooser } from "./folder_chooser.tsx";

export function NewMachine({ answer }: NamedDialogProps<"new">) {
  const nodes = useProjects() ?? [];
  const [name, setName] = useState("New machine");
  const [folder, setFolder] = useState<string | null>(null);
  const [place, setPlace] = useState<ProjectNode | null>(null);
  const { file, refusal } = chosenFolder(nodes, place, folder ?? folderName(name));
  const done = () => {
    if (file && name.trim() !== "") answer({ file, name: name.trim() });
  };
  return (
    <Dialog
      title="New machine"
      width={620}
      height={600}
      onClose={() => answer(null)}
      footer={
        <>
          <Button onClick={() => answer(null)}>Cancel</Button>
          <Button kind="primary" disabled={!file || name.trim() === ""} onClick={done}>
            Create
          </Button>
        </>
      }
    >
      <div className="form">
        <TextField
          label="Name of the machine"
          value={name}
          onInput={setName}
          autoFocus
          refusal={name.trim() === "" ? "The machine needs a name." : null}
          onKeyDown={(event) => event.key === "Enter" && done()}
        />
        <FolderChooser
          autoFocus={false}
          name={folder ?? folderName(name)}
          onName={setFolder}
          place={place}
          onPlace={setPlace}
          refusal={nodes.length > 0 ? refusal : null}
          onDone={done}
        />
      </div>
    </Dialog>
  );
}
