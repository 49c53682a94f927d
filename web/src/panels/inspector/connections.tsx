/** Transitions or data flows of a state: around it, and inside. */

import { Plus } from "lucide-react";
import { useState } from "react";
import { type ElementRef, keyOf } from "../../model/element.ts";
import {
  type Connection,
  type ConnectionRef,
  connectionInWords,
  connectionsIn,
  connectionsOf,
} from "../../model/ends.ts";
import { isContainer } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";
import { type ConnectionEnd, connect, reconnect } from "../../plan/connect.ts";
import { removeElements } from "../../plan/states.ts";
import type { Made } from "../../store/page/apply_plan.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { Table, type TableColumn } from "../../ui/table.tsx";
import { EndSelect } from "./end_select.tsx";
import { Fold } from "./fold.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { Refusal, useRefusal } from "./refusal.tsx";
import { ROW_BUTTONS_WIDTH, RowButtons } from "./row_buttons.tsx";

const WORDS = {
  transition: { many: "Transitions", one: "transition" },
  data_flow: { many: "Data flows", one: "data flow" },
} as const;

const ROWS_MAX = 12;

interface ConnectionsProps {
  readonly inspected: InspectedState;
  readonly kind: ConnectionRef["kind"];
}

export function Connections({ inspected, kind }: ConnectionsProps) {
  const { path, state, machine } = inspected;
  const parent = parentOf(path);
  const around = connectionsOf(machine, path, kind).filter(
    ({ element }) => element.path === parent,
  );
  const hasInside = isContainer(state);
  const inside = hasInside ? connectionsIn(machine, path, kind) : [];
  const count = around.length + inside.length;
  return (
    <Fold title={WORDS[kind].many} count={count} openAtFirst={count > 0}>
      {parent !== null && machine.state(parent)?.kind !== "library" && (
        <Group
          inspected={inspected}
          kind={kind}
          container={parent}
          rows={around}
          title={hasInside ? "Outside" : null}
        />
      )}
      {hasInside && (
        <Group inspected={inspected} kind={kind} container={path} rows={inside} title="Inside" />
      )}
    </Fold>
  );
}

interface ConnectionGroupProps extends ConnectionsProps {
  readonly container: string;
  readonly rows: readonly Connection[];
  readonly title: string | null;
}

function Group({ inspected, kind, container, rows, title }: ConnectionGroupProps) {
  const { machine, readOnly, edit } = inspected;
  const [refusal, run] = useRefusal();
  const [isAdding, setAdding] = useState(false);
  const { one } = WORDS[kind];
  const remove = ({ element }: Connection) => run(edit((now) => removeElements(now, [element])));
  const place = machine.state(container)?.name ?? container;
  return (
    <div className="inspector-group">
      <div className="inspector-group-head">
        <h4>{title ?? `In ${place}`}</h4>
        {!readOnly && (
          <IconButton
            className="inspector-mini"
            label={`Add ${one} in ${place}`}
            icon={<Plus size={14} />}
            pressed={isAdding}
            onClick={() => setAdding(!isAdding)}
          />
        )}
      </div>
      {rows.length === 0 ? (
        <p className="inspector-none">No {one} here.</p>
      ) : (
        <Table
          label={`${WORDS[kind].many} in ${place}`}
          columns={columnsOf(inspected, run, remove)}
          rows={rows}
          id={({ element }) => keyOf(element)}
          rowsMax={ROWS_MAX}
          hideHead
          onOpen={({ element }) => inspected.show(element)}
          onHover={(row) => inspected.hover(row?.element ?? null)}
          onDelete={readOnly ? undefined : remove}
        />
      )}
      {isAdding && (
        <Adding
          key={container}
          inspected={inspected}
          kind={kind}
          container={container}
          run={run}
          onClose={() => setAdding(false)}
        />
      )}
      <Refusal text={refusal} />
    </div>
  );
}

type Run = (made: Made) => void;

function columnsOf(
  { path, machine, readOnly, edit, show }: InspectedState,
  run: Run,
  remove: (row: Connection) => void,
): readonly TableColumn<Connection>[] {
  const end = (which: ConnectionEnd, label: string, width: string): TableColumn<Connection> => ({
    key: which,
    title: label,
    width,
    cell: ({ element, ends }) => (
      <EndSelect
        machine={machine}
        container={element.path}
        kind={element.kind}
        end={which}
        label={`${label} of ${connectionInWords(machine, element)}`}
        hideLabel
        own={path}
        value={ends[which]}
        other={ends[which === "from" ? "to" : "from"]}
        disabled={readOnly}
        onChange={(target) => {
          if (target) run(edit((now) => reconnect(now, element, which, target)));
        }}
      />
    ),
  });
  return [
    end("from", "From", "minmax(0, 1.2fr)"),
    { key: "arrow", title: "", width: "28px", cell: () => <span aria-hidden>→</span> },
    end("to", "To", "minmax(0, 1fr)"),
    {
      key: "buttons",
      title: "Actions",
      hideTitle: true,
      width: ROW_BUTTONS_WIDTH,
      cell: (row) => (
        <RowButtons
          what={connectionInWords(machine, row.element)}
          onShow={() => show(row.element)}
          onRemove={readOnly ? undefined : () => remove(row)}
        />
      ),
    },
  ];
}

interface AddingProps extends ConnectionsProps {
  readonly container: string;
  readonly run: Run;
  readonly onClose: () => void;
}

function Adding({ inspected: { machine, edit }, kind, container, run, onClose }: AddingProps) {
  const [from, setFrom] = useState<ElementRef | null>(null);
  const [to, setTo] = useState<ElementRef | null>(null);
  const add = async () => {
    if (!from || !to) return null;
    const refusal = await edit((now) => connect(now, from, to));
    if (refusal === null) {
      setFrom(null);
      setTo(null);
    }
    return refusal;
  };
  const shared = { machine, container, kind } as const;
  return (
    <div className="inspector-adding">
      <EndSelect {...shared} end="from" label="From" value={from} other={to} onChange={setFrom} />
      <EndSelect {...shared} end="to" label="To" value={to} other={from} onChange={setTo} />
      <div className="inspector-bar">
        <Button onClick={onClose}>Close</Button>
        <Button kind="primary" disabled={!from || !to} onClick={() => run(add())}>
          Add {WORDS[kind].one}
        </Button>
      </div>
    </div>
  );
}
