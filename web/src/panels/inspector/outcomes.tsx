/** Outcomes of a state, each with its target. */

import { Plus } from "lucide-react";
import type { OutcomeDocument } from "../../model/generated/protocol.ts";
import { outcomesOf } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";
import { addOutcome } from "../../plan/ports.ts";
import { removeElements } from "../../plan/states.ts";
import { IconButton } from "../../ui/button.tsx";
import type { TableColumn } from "../../ui/table.tsx";
import { Fold } from "./fold.tsx";
import { Goal } from "./goal.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { PartTable, PasteButton, useAdded } from "./part_table.tsx";
import { Refusal, useRefusal } from "./refusal.tsx";
import { useRenaming } from "./renaming.tsx";
import { ROW_BUTTONS_WIDTH, RowButtons } from "./row_buttons.tsx";

export function Outcomes({ inspected }: { inspected: InspectedState }) {
  const { path, state, machine, readOnly, edit } = inspected;
  const [refusal, run] = useRefusal();
  const [rename, asking] = useRenaming(inspected);
  const outcomes = outcomesOf(state).toSorted(asPeopleRead);
  const [added, adding] = useAdded(outcomes);
  const canChange = !readOnly && !state.library;
  const refOf = ({ id }: OutcomeDocument) => ({ kind: "outcome", path, id }) as const;
  const remove = (outcome: OutcomeDocument) =>
    run(edit((now) => removeElements(now, [refOf(outcome)])));
  const container = parentOf(path);
  const goal = (around: string): TableColumn<OutcomeDocument> => ({
    key: "to",
    title: "Leads to",
    width: "minmax(0, 1.4fr)",
    cell: (outcome) => (
      <Goal
        inspected={inspected}
        container={around}
        outcome={outcome}
        label={`Target of ${outcome.name}`}
        hideLabel
        run={run}
      />
    ),
  });
  const columns: readonly TableColumn<OutcomeDocument>[] = [
    { key: "id", title: "Id", width: "34px", align: "right", cell: ({ id }) => id },
    {
      key: "name",
      title: "Name",
      cell: ({ name }) => <span title={name}>{name}</span>,
      edit: {
        value: ({ id, name }) => (canChange && id >= 0 ? name : null),
        commit: (outcome, text) => rename(refOf(outcome), text),
      },
    },
    ...(container === null || machine.state(container)?.kind === "library"
      ? []
      : [goal(container)]),
    {
      key: "buttons",
      title: "Actions",
      hideTitle: true,
      width: ROW_BUTTONS_WIDTH,
      cell: (outcome) => (
        <RowButtons
          what={`outcome ${outcome.name}`}
          onShow={() => inspected.show(refOf(outcome))}
          onRemove={canChange && outcome.id >= 0 ? () => remove(outcome) : undefined}
        />
      ),
    },
  ];
  const add = (
    <>
      <PasteButton inspected={inspected} kind="outcome" run={run} words="outcome" />
      <IconButton
        label="Add outcome"
        icon={<Plus size={15} />}
        onClick={() => {
          adding();
          run(edit((now) => addOutcome(now, path)));
        }}
      />
    </>
  );
  return (
    <Fold title="Outcomes" count={outcomes.length} actions={canChange ? add : null}>
      <PartTable
        key={path}
        inspected={inspected}
        kind="outcome"
        run={run}
        label={`Outcomes of ${state.name}`}
        columns={columns}
        rows={outcomes}
        added={added}
        canChange={canChange}
      />
      <Refusal text={refusal} />
      {asking}
    </Fold>
  );
}

/** Order: the state's own outcomes first, aborted and preempted last. */
function asPeopleRead(one: OutcomeDocument, other: OutcomeDocument): number {
  const isLast = Number(one.id < 0) - Number(other.id < 0);
  return isLast === 0 ? Math.abs(one.id) - Math.abs(other.id) : isLast;
}
