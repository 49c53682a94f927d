/** General properties of a state: its name, id and kind, the start state of a container, and the library that it runs. */

import { ExternalLink } from "lucide-react";
import type { StateKind } from "../../model/generated/protocol.ts";
import { readLayout } from "../../model/layout_reader.ts";
import { isConcurrent, startOf } from "../../model/machine.ts";
import { idOf, parentOf } from "../../model/path.ts";
import { KIND_WORDS } from "../../plan/legal.ts";
import { showContent } from "../../plan/move.ts";
import { changeKind, clearStart, rename, setId, setStart } from "../../plan/states.ts";
import type { Made } from "../../store/page/apply_plan.ts";
import { select } from "../../store/page/view.ts";
import { Button } from "../../ui/button.tsx";
import { Checkbox, Select, TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Fold } from "./fold.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { Refusal, useRefusal } from "./refusal.tsx";

export function General({ inspected }: { inspected: InspectedState }) {
  const { path, state, readOnly, edit } = inspected;
  const [refusal, run] = useRefusal();
  return (
    <Fold title="General">
      <div className="inspector-fields">
        <TextField
          key={`name ${path}`}
          label="Name"
          value={state.name}
          readOnly={readOnly}
          onCommit={(text) => edit((machine) => rename(machine, path, text))}
        />
        <TextField
          key={`id ${path}`}
          label="Id"
          mono
          value={idOf(path)}
          readOnly={readOnly || state.kind === "decider"}
          onCommit={(text) => changeId(inspected, text)}
        />
        <Kind inspected={inspected} run={run} />
        <Start inspected={inspected} run={run} />
        {state.library && <LibraryOf inspected={inspected} run={run} />}
      </div>
      <Refusal text={refusal} />
    </Fold>
  );
}

/** Changes the id, and selects the state at its new path. */
async function changeId({ path, tab, edit }: InspectedState, text: string): Promise<string | null> {
  const parent = parentOf(path);
  const now = parent === null ? text.trim() : `${parent}/${text.trim()}`;
  const refusal = await edit((machine) => setId(machine, path, text));
  if (refusal !== null) return refusal;
  select(tab.view, [{ kind: "state", path: now }]);
  return null;
}

interface PartProps {
  readonly inspected: InspectedState;
  readonly run: (made: Made) => void;
}

const KINDS: readonly StateKind[] = ["execution", "hierarchy", "barrier", "preemptive"];

function Kind({ inspected: { path, state, readOnly, edit }, run }: PartProps) {
  const isFixed = !KINDS.includes(state.kind);
  const kinds = isFixed ? [state.kind] : KINDS;
  return (
    <Select
      label="Kind"
      value={state.kind}
      disabled={readOnly || isFixed}
      options={kinds.map((value) => ({ value, title: KIND_WORDS[value] }))}
      onChange={(kind) => run(edit((machine) => changeKind(machine, path, kind)))}
    />
  );
}

function Start({ inspected: { path, state, machine, readOnly, edit }, run }: PartProps) {
  const parent = parentOf(path);
  const around = parent === null ? undefined : machine.state(parent);
  if (parent === null || !around || around.kind === "library") return null;
  if (state.kind === "decider" || isConcurrent(around)) return null;
  const isStart = startOf(around)?.to_state === idOf(path);
  return (
    <Checkbox
      label={`Start of ${around.name}`}
      checked={isStart}
      disabled={readOnly}
      onChange={(wanted) =>
        run(edit((now) => (wanted ? setStart(now, path) : clearStart(now, parent))))
      }
    />
  );
}

function LibraryOf({ inspected, run }: PartProps) {
  const { path, state, tab, readOnly, edit } = inspected;
  const contents = useSignal(tab.view.contents);
  const { library } = state;
  if (!library) return null;
  const show = async (shown: boolean) => {
    tab.view.contents.value = new Map(tab.view.contents.peek()).set(path, shown);
    if (shown) await tab.session.loadLibrary(path);
    return readOnly ? null : edit((machine) => showContent(machine, path, shown));
  };
  const open = () => {
    select(tab.view, [{ kind: "state", path }]);
    inspected.run("file.open-library");
  };
  return (
    <>
      <TextField label="Library" mono readOnly value={`${library.path}/${library.name}`} />
      <TextField label="Version" readOnly value={library.version ?? "none"} />
      <Button icon={<ExternalLink size={14} />} onClick={open}>
        Open library
      </Button>
      <Checkbox
        label="Show content"
        checked={contents.get(path) ?? readLayout(state).showsContent}
        onChange={(shown) => run(show(shown))}
      />
      {library.missing && (
        <p className="inspector-warning" role="note">
          Library not found: {library.missing}
        </p>
      )}
    </>
  );
}
