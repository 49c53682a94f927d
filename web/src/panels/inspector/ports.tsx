/** Inputs, outputs or scoped variables of a state, as a table that is edited in place. */

import { Plus } from "lucide-react";
import { readDefault, textOfDefault } from "../../model/default_text.ts";
import type { DataPort } from "../../model/ends.ts";
import type { PortDocument, RuntimeValueDocument } from "../../model/generated/protocol.ts";
import { type Machine, type PortKind, portsOf } from "../../model/machine.ts";
import { COMMON_TYPES, shortType } from "../../model/types.ts";
import { isRefused, type Planned } from "../../plan/plan.ts";
import {
  addPort,
  setPortDefault,
  setPortType,
  setRuntimeValue,
  useRuntimeValue as withRuntimeValue,
} from "../../plan/ports.ts";
import { removeElements } from "../../plan/states.ts";
import type { Made } from "../../store/page/apply_plan.ts";
import { IconButton } from "../../ui/button.tsx";
import { Checkbox, type Commit } from "../../ui/field.tsx";
import type { TableColumn } from "../../ui/table.tsx";
import { Fold } from "./fold.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { PartTable, PasteButton, useAdded } from "./part_table.tsx";
import { Refusal, useRefusal } from "./refusal.tsx";
import { useRenaming } from "./renaming.tsx";
import { ROW_BUTTONS_WIDTH, RowButtons } from "./row_buttons.tsx";

export const PORT_TITLES = {
  input: { many: "Inputs", single: "Input", one: "input", value: "Default" },
  output: { many: "Outputs", single: "Output", one: "output", value: "Default" },
  scoped_variable: {
    many: "Scoped variables",
    single: "Scoped variable",
    one: "scoped variable",
    value: "Initial value",
  },
} as const;

export function Ports({ inspected, kind }: { inspected: InspectedState; kind: PortKind }) {
  const { path, state, readOnly, edit } = inspected;
  const [refusal, run] = useRefusal();
  const [rename, asking] = useRenaming(inspected);
  const ports = portsOf(state, kind);
  const [added, adding] = useAdded(ports);
  const { many, one } = PORT_TITLES[kind];
  const isLibrary = state.library != null;
  const canChange = !readOnly && !isLibrary;
  const refOf = ({ id }: PortDocument): DataPort => ({ kind, path, id });
  const remove = (port: PortDocument) => run(edit((now) => removeElements(now, [refOf(port)])));
  const buttons: TableColumn<PortDocument> = {
    key: "buttons",
    title: "Actions",
    hideTitle: true,
    width: ROW_BUTTONS_WIDTH,
    cell: (port) => (
      <RowButtons
        what={`${one} ${port.name}`}
        onShow={() => inspected.show(refOf(port))}
        onRemove={canChange ? () => remove(port) : undefined}
      />
    ),
  };
  const columns = isLibrary
    ? libraryColumns(inspected, kind, run)
    : ownColumns(inspected, kind, canChange, rename);
  const add = (
    <>
      <PasteButton inspected={inspected} kind={kind} run={run} words={one} />
      <IconButton
        label={`Add ${one}`}
        icon={<Plus size={15} />}
        onClick={() => {
          adding();
          run(edit((now) => addPort(now, path, kind)));
        }}
      />
    </>
  );
  return (
    <Fold
      title={many}
      count={ports.length}
      openAtFirst={ports.length > 0}
      actions={canChange ? add : null}
    >
      {ports.length === 0 ? (
        <p className="inspector-none">No {many.toLowerCase()}.</p>
      ) : (
        <PartTable
          key={path}
          inspected={inspected}
          kind={kind}
          run={run}
          label={`${many} of ${state.name}`}
          columns={[...columns, buttons]}
          rows={ports}
          added={added}
          canChange={canChange}
        />
      )}
      <Refusal text={refusal} />
      {asking}
    </Fold>
  );
}

function ownColumns(
  { path, machine, edit }: InspectedState,
  kind: PortKind,
  canChange: boolean,
  rename: (element: DataPort, name: string) => Commit,
): readonly TableColumn<PortDocument>[] {
  const refOf = ({ id }: PortDocument): DataPort => ({ kind, path, id });
  const value = (text: (port: PortDocument) => string) => (port: PortDocument) =>
    canChange ? text(port) : null;
  return [
    {
      key: "name",
      title: "Name",
      width: "minmax(0, 1.2fr)",
      cell: ({ name }) => <span title={name}>{name}</span>,
      edit: { value: value(({ name }) => name), commit: (port, text) => rename(refOf(port), text) },
    },
    {
      key: "type",
      title: "Type",
      cell: ({ data_type }) => <code title={data_type}>{shortType(data_type)}</code>,
      edit: {
        value: value(({ data_type }) => shortType(data_type)),
        commit: (port, text) => edit((now) => setPortType(now, refOf(port), text)),
        suggestions: () => typesIn(machine),
        mono: true,
      },
    },
    {
      key: "default",
      title: PORT_TITLES[kind].value,
      cell: (port) => <Value value={textOfDefault(port.default)} />,
      edit: {
        value: value((port) => textOfDefault(port.default)),
        commit: (port, text) =>
          edit((now) => read(text, port, (literal) => setPortDefault(now, refOf(port), literal))),
        mono: true,
      },
    },
  ];
}

function Value({ value, faint = false }: { value: string; faint?: boolean }) {
  return (
    <code title={value} className={faint ? "inspector-faint" : undefined}>
      {value}
    </code>
  );
}

/** Plan for the text of a port's value. */
export function read(
  text: string,
  port: PortDocument,
  then: (value: NonNullable<PortDocument["default"]> | null) => Planned,
): Planned {
  const literal = readDefault(text, port.data_type);
  return isRefused(literal) ? literal : then(literal.value);
}

/** Columns of a library state, which has the defaults of its library but may override them. */
function libraryColumns(
  { path, state, readOnly, edit }: InspectedState,
  kind: PortKind,
  run: (made: Made) => void,
): readonly TableColumn<PortDocument>[] {
  const refOf = ({ id }: PortDocument): DataPort => ({ kind, path, id });
  const list = kind === "input" ? state.library?.inputs : state.library?.outputs;
  const set = new Map<number, RuntimeValueDocument>(list?.map((each) => [each.port, each]));
  const valueHere = (port: PortDocument) => set.get(port.id)?.value ?? port.default;
  return [
    {
      key: "name",
      title: "Name",
      width: "minmax(0, 1.2fr)",
      cell: ({ name, data_type }) => <span title={`${name}: ${shortType(data_type)}`}>{name}</span>,
    },
    {
      key: "default",
      title: "Library",
      cell: (port) => <Value value={textOfDefault(port.default)} faint />,
    },
    {
      key: "value",
      title: "Here",
      cell: (port) => (
        <Value value={textOfDefault(valueHere(port))} faint={!set.get(port.id)?.used} />
      ),
      edit: {
        value: (port) => (readOnly ? null : textOfDefault(valueHere(port))),
        commit: (port, text) =>
          edit((now) => read(text, port, (value) => setRuntimeValue(now, refOf(port), value))),
        mono: true,
      },
    },
    {
      key: "used",
      title: "Use",
      width: "48px",
      cell: (port) => (
        <Checkbox
          label={<span className="visually-hidden">Use the value of {port.name} here</span>}
          title="Use the value here instead of the library's"
          checked={set.get(port.id)?.used ?? false}
          disabled={readOnly}
          onChange={(used) => run(edit((now) => withRuntimeValue(now, refOf(port), used)))}
        />
      ),
    },
  ];
}

/** Suggested types: the common ones, and those in the machine. */
export function typesIn(machine: Machine): readonly string[] {
  const types = new Set(COMMON_TYPES);
  for (const path of machine.paths()) {
    const state = machine.state(path);
    if (!state) continue;
    for (const list of ["input", "output", "scoped_variable"] as const)
      for (const { data_type } of portsOf(state, list)) types.add(shortType(data_type));
  }
  return [...types];
}
