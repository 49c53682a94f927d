/** Inspector of an outcome: its name, its target, and the connections that lead to it. */

import { keyOf } from "../../model/element.ts";
import { type Connection, connectionInWords, connectionsIn } from "../../model/ends.ts";
import { outcomesOf } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";
import { TextField } from "../../ui/field.tsx";
import { Fold } from "./fold.tsx";
import { Goal } from "./goal.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { Refusal, useRefusal } from "./refusal.tsx";
import { useRenaming } from "./renaming.tsx";

export function OutcomeView({ inspected, id }: { inspected: InspectedState; id: number }) {
  const { path, state, machine, readOnly } = inspected;
  const [refusal, run] = useRefusal();
  const [rename, asking] = useRenaming(inspected);
  const element = { kind: "outcome", path, id } as const;
  const outcome = outcomesOf(state).find((each) => each.id === id);
  if (!outcome) return null;
  const key = keyOf(element);
  const container = parentOf(path);
  const leading = connectionsIn(machine, path, "transition").filter(
    ({ ends }) => keyOf(ends.to) === key,
  );
  return (
    <>
      <Fold title="Outcome">
        <div className="inspector-fields">
          <TextField
            key={key}
            label="Name"
            value={outcome.name}
            readOnly={readOnly || state.library != null || id < 0}
            onCommit={(text) => rename(element, text)}
          />
          <TextField label="Id" mono readOnly value={String(id)} />
          {container !== null && (
            <Goal
              inspected={inspected}
              container={container}
              outcome={outcome}
              label="Leads to"
              run={run}
            />
          )}
        </div>
        <Refusal text={refusal} />
        {asking}
      </Fold>
      {leading.length > 0 && (
        <Fold title="Reached from inside through" count={leading.length}>
          <Leading inspected={inspected} rows={leading} />
        </Fold>
      )}
    </>
  );
}

function Leading({ inspected, rows }: { inspected: InspectedState; rows: readonly Connection[] }) {
  return (
    <ul className="inspector-list">
      {rows.map(({ element }) => (
        <li key={keyOf(element)}>
          <button type="button" className="inspector-link" onClick={() => inspected.show(element)}>
            {connectionInWords(inspected.machine, element)}
          </button>
        </li>
      ))}
    </ul>
  );
}
