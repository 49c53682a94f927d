/** Dialog that renames a global variable, with a preview of the change in every script. */

import { useState } from "react";
import { performIn } from "../../commands/perform.ts";
import type { GlobalUse, GlobalVariable } from "../../model/globals.ts";
import { namesTo } from "../../model/machine.ts";
import { renameGlobal } from "../../plan/rename_in_script.ts";
import type { OpenTab, Page } from "../../store/page/page.ts";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { TextField } from "../../ui/field.tsx";

interface RenameGlobalProps {
  readonly page: Page;
  readonly tab: OpenTab;
  readonly variable: GlobalVariable;
  /** Names of the other variables. */
  readonly taken: readonly string[];
  readonly onClose: () => void;
}

export function RenameGlobal({ page, tab, variable, taken, onClose }: RenameGlobalProps) {
  const { machine } = tab.session;
  const [name, setName] = useState(variable.name);
  const wanted = name.trim();
  const own = variable.uses.filter(({ path }) => !machine.isInLibrary(path));
  const foreign = variable.uses.length - own.length;
  const rename = async () => {
    const isDone = await performIn(page, tab, renameGlobal(machine, variable.name, wanted));
    if (isDone) onClose();
  };
  return (
    <Dialog
      title={`Rename global variable ${variable.name}`}
      width={600}
      onClose={onClose}
      footer={
        <>
          <Button onClick={onClose}>Cancel</Button>
          <Button
            kind="primary"
            disabled={wanted === "" || wanted === variable.name}
            onClick={() => void rename()}
          >
            Rename everywhere
          </Button>
        </>
      }
    >
      <TextField
        label="New name"
        value={variable.name}
        autoFocus
        onInput={setName}
        onKeyDown={(event) => {
          if (event.key === "Enter" && wanted !== "" && wanted !== variable.name) void rename();
        }}
      />
      {wanted !== variable.name && taken.includes(wanted) && (
        <p className="globals-warning" role="note">
          A variable {wanted} already exists: renaming would merge the two.
        </p>
      )}
      {foreign > 0 && (
        <p className="globals-warning" role="note">
          Libraries keep the old name: {foreign === 1 ? "one place" : `${foreign} places`}. Rename
          it in the libraries themselves.
        </p>
      )}
      <ul className="globals-places" aria-label="Places to rename">
        {own.map((use) => (
          <Place key={`${use.path} ${use.line} ${use.text}`} tab={tab} use={use} />
        ))}
      </ul>
    </Dialog>
  );
}

function Place({ tab, use }: { tab: OpenTab; use: GlobalUse }) {
  return (
    <li>
      <span className="globals-soft">
        {namesTo(tab.session.machine, use.path).join(" / ")}
        {use.line !== null && `, line ${use.line}`}
      </span>
      <code>{use.text}</code>
    </li>
  );
}
