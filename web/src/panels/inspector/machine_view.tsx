/** Inspector of the machine while nothing is selected: its general properties, its size, and its interface. */

import { useMemo } from "react";
import type { StateKind } from "../../model/generated/protocol.ts";
import { dataFlowsOf, type Machine, transitionsOf } from "../../model/machine.ts";
import { KIND_WORDS } from "../../plan/legal.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { useDebounced } from "../../ui/debounced.ts";
import { TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Description } from "./description.tsx";
import { Drafts } from "./drafts.tsx";
import { Fold } from "./fold.tsx";
import { GlobalsInRun, InRun } from "./in_run.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { Outcomes } from "./outcomes.tsx";
import { Ports } from "./ports.tsx";

export function MachineView({ inspected }: { inspected: InspectedState }) {
  const { machine, tab, readOnly, edit } = inspected;
  const status = useSignal(tab.session.status);
  const { header } = machine;
  const file = status?.summary.file;
  return (
    <>
      <InRun inspected={inspected} />
      <GlobalsInRun inspected={inspected} />
      <Fold title="Machine">
        <div className="inspector-fields">
          <TextField
            key={tab.session.id}
            label="Version"
            value={header.version ?? ""}
            readOnly={readOnly}
            placeholder="none"
            onCommit={(text) =>
              edit(() => ({
                name: "Change version of the machine",
                edit: { edit: "set_version", version: text.trim() || null },
              }))
            }
          />
          <TextField
            label="Folder"
            mono
            readOnly
            value={file ? `${file.project}/${file.path}` : "not saved yet"}
          />
          <TextField label="Created (UTC)" readOnly value={header.creation_time} />
          <TextField
            label="Written by"
            readOnly
            value={header.used_rafcon_version ? `RAFCON ${header.used_rafcon_version}` : "unknown"}
          />
        </div>
      </Fold>
      <Drafts context={inspected} />
      <Counts tab={tab} />
      <Description key={`description ${tab.session.id}`} inspected={inspected} />
      <Ports inspected={inspected} kind="input" />
      <Ports inspected={inspected} kind="output" />
      <Outcomes inspected={inspected} />
    </>
  );
}

const PATIENCE_MS = 200;

function Counts({ tab: { session } }: { tab: OpenTab }) {
  const version = useDebounced(useSignal(session.version), PATIENCE_MS);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the machine is a mutable object; its version changes with it
  const counts = useMemo(() => countsOf(session.machine), [session, version]);
  const [states] = counts;
  return (
    <Fold title="Contents" count={states?.[1]}>
      <dl className="inspector-counts">
        {counts.map(([word, count]) => (
          <div key={word}>
            <dt>{word}</dt>
            <dd>{count.toLocaleString("en")}</dd>
          </div>
        ))}
      </dl>
    </Fold>
  );
}

/** Number of states in total and of each kind, and of connections. Kinds without states are left out. */
function countsOf(machine: Machine): readonly (readonly [string, number])[] {
  const kinds = new Map<StateKind, number>();
  let [states, transitions, flows, depth] = [0, 0, 0, 0];
  for (const path of machine.paths()) {
    const state = machine.state(path);
    if (!state) continue;
    states += 1;
    kinds.set(state.kind, (kinds.get(state.kind) ?? 0) + 1);
    transitions += transitionsOf(state).length;
    flows += dataFlowsOf(state).length;
    depth = Math.max(depth, path.split("/").length);
  }
  const ofKinds = [...kinds].map(([kind, count]) => [KIND_WORDS[kind], count] as const);
  return [
    ["states", states],
    ...ofKinds,
    ["transitions", transitions],
    ["data flows", flows],
    ["levels", depth],
  ];
}
