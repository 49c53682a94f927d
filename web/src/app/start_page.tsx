/** The page without an open machine: recent machines, all machines, and first steps. */

import { Plus } from "lucide-react";
import { useState } from "react";
import type { MachineFile } from "../model/generated/protocol.ts";
import { Button } from "../ui/button.tsx";
import { TextField } from "../ui/field.tsx";
import { useComputed, useSignal } from "../ui/signals.ts";
import { useShownKey } from "./keys_shown.ts";
import { ProjectTree, useProjects } from "./project_tree.tsx";
import { useSession } from "./session_context.tsx";
import "./canvas_area.css";

const RECENT_SHOWN = 8;

export function StartPage() {
  const { commands, context, page } = useSession();
  const shown = useShownKey();
  const projects = useProjects();
  const [search, setSearch] = useState("");
  const [selected, setSelected] = useState<MachineFile | null>(null);
  const canMake = useComputed(
    () => commands.get("file.new")?.enabled?.(context()) !== false,
    [commands],
  );
  const open = (file: MachineFile) => commands.run("file.open", context(), file);
  return (
    <main className="start">
      <header className="start-head">
        <h1 className="start-title">What should the robot do?</h1>
        <p className="start-lead">Open a machine or create a new one.</p>
        <div className="start-actions">
          <Button
            kind="primary"
            icon={<Plus size={15} aria-hidden />}
            disabled={!canMake}
            keys={shown("file.new")}
            title="New machine"
            onClick={() => commands.run("file.new", context())}
          >
            New machine
          </Button>
          <Button onClick={() => page && commands.run("help.palette", context())}>
            Search everything {shown("help.palette")}
          </Button>
        </div>
      </header>
      <Lately onOpen={open} />
      <section className="start-column" aria-label="Projects">
        <h2>Projects</h2>
        <TextField
          label="Find a machine"
          hideLabel
          type="search"
          placeholder="Find a machine"
          value={search}
          onInput={setSearch}
        />
        <div className="start-tree">
          {projects && (
            <ProjectTree
              nodes={projects}
              search={search}
              selected={selected}
              onSelect={(node) => setSelected(node.file)}
              onOpen={(node) => node.kind === "machine" && open(node.file)}
            />
          )}
        </div>
      </section>
    </main>
  );
}

/** Machines that were open lately here, and those that are open on the server. */
function Lately({ onOpen }: { onOpen: (file: MachineFile) => void }) {
  const { page } = useSession();
  const { recent } = useSignal(page.settings);
  const serverStatus = useSignal(page.serverStatus);
  const projects = useSignal(page.projects);
  const name = (file: MachineFile) => projects.find(({ id }) => id === file.project)?.name;
  const machines = serverStatus?.machines ?? [];
  return (
    <section className="start-column" aria-label="Recent">
      {machines.length > 0 && (
        <>
          <h2>Open on the server</h2>
          <ul className="start-list">
            {machines.map((machine) => (
              <li key={machine.id}>
                <button type="button" onClick={() => void page.join(machine.id)}>
                  <span>
                    {machine.name}
                    {machine.is_changed ? " •" : ""}
                  </span>
                  <small>
                    {machine.file?.path ?? "not saved yet"}
                    {machine.is_changed ? ", has unsaved edits" : ""}
                  </small>
                </button>
              </li>
            ))}
          </ul>
        </>
      )}
      <h2>Recent</h2>
      {recent.length === 0 && (
        <p className="start-lead">
          Machines that you open appear here. Double-click one on the right.
        </p>
      )}
      <ul className="start-list">
        {recent.slice(0, RECENT_SHOWN).map((file) => (
          <li key={`${file.project}/${file.path}`}>
            <button type="button" onClick={() => onOpen(file)}>
              <span>{file.path.split("/").at(-1)}</span>
              <small>
                {name(file) ?? file.project} / {file.path}
              </small>
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}
