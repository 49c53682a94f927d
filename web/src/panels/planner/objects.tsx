/** Objects of the world: a table, or the content of a file. */

import { FileUp, Plus, Trash2 } from "lucide-react";
import { useRef } from "react";
import { numberedName } from "../../model/names.ts";
import { typesIn, valueFault, type WorldObject, withFile } from "../../store/planner/inputs.ts";
import type { Planner } from "../../store/planner/planner.ts";
import { IconButton } from "../../ui/button.tsx";
import { Section } from "../../ui/section.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Table, type TableColumn } from "../../ui/table.tsx";
import { useHost } from "../context.tsx";

const ROWS_MAX = 8;
const NAME = /^[A-Za-z][\w-]*$/;

export function Objects({ planner }: { readonly planner: Planner }) {
  const { page } = useHost().context();
  const { objects } = useSignal(planner.inputs);
  const domain = useSignal(planner.domain);
  const file = useRef<HTMLInputElement>(null);
  const types = typesIn(domain);
  const put = (next: readonly WorldObject[]) => planner.change({ objects: next });
  const add = () => {
    const name = numberedName(
      "object",
      objects.map((each) => each.name),
    );
    put([...objects, { name, type: objects.at(-1)?.type ?? types[0] ?? "", value: "" }]);
  };
  const load = async (chosen: File | undefined) => {
    if (!chosen) return;
    const next = withFile(planner.inputs.peek(), await chosen.text());
    if (typeof next === "string") page.tell({ level: "warning", text: `${chosen.name}: ${next}` });
    else planner.change(next);
  };
  const actions = (
    <>
      <IconButton
        label="Load a PDDL problem or the robot's world file"
        icon={<FileUp size={14} />}
        onClick={() => file.current?.click()}
      />
      <IconButton label="Add object" icon={<Plus size={15} />} onClick={add} />
    </>
  );
  return (
    <Section title="Objects" count={objects.length} actions={actions}>
      <input
        ref={file}
        type="file"
        hidden
        accept=".pddl,.json"
        aria-label="PDDL problem or world file"
        onChange={({ currentTarget }) => {
          void load(currentTarget.files?.[0]);
          currentTarget.value = "";
        }}
      />
      {objects.length === 0 ? (
        <p className="planner-soft">
          Objects that facts and goal refer to. Add objects, or load a PDDL problem or the robot’s
          world file (JSON with a value for each object).
        </p>
      ) : (
        <Table
          label="Objects"
          columns={columnsOf(objects, types, put)}
          rows={objects}
          id={({ name }) => name}
          rowsMax={ROWS_MAX}
          onDelete={({ name }) => put(objects.filter((each) => each.name !== name))}
        />
      )}
    </Section>
  );
}

function columnsOf(
  objects: readonly WorldObject[],
  types: readonly string[],
  put: (next: readonly WorldObject[]) => void,
): readonly TableColumn<WorldObject>[] {
  const change = ({ name }: WorldObject, changed: Partial<WorldObject>) =>
    put(objects.map((each) => (each.name === name ? { ...each, ...changed } : each)));
  const nameFault = ({ name }: WorldObject, text: string) => {
    if (!NAME.test(text)) return "A name has letters, digits, - and _, and begins with a letter.";
    const isTaken = objects.some((each) => each.name !== name && isSame(each.name, text));
    return isTaken ? `There is a ${text} already.` : null;
  };
  return [
    {
      key: "name",
      title: "Name",
      cell: ({ name }) => <span title={name}>{name}</span>,
      edit: {
        value: ({ name }) => name,
        check: nameFault,
        commit: (row, name) => change(row, { name }),
      },
    },
    {
      key: "type",
      title: "Type",
      cell: ({ type }) => <span title={type}>{type}</span>,
      edit: {
        value: ({ type }) => type,
        suggestions: () => types,
        commit: (row, type) => change(row, { type: type.trim() }),
      },
    },
    {
      key: "value",
      title: "Value",
      cell: ({ value }) => <code title={value}>{value}</code>,
      edit: {
        value: ({ value }) => value,
        mono: true,
        check: (_, text) => valueFault(text),
        commit: (row, value) => change(row, { value }),
      },
    },
    {
      key: "buttons",
      title: "Actions",
      hideTitle: true,
      width: "28px",
      cell: ({ name }) => (
        <IconButton
          className="planner-mini"
          label={`Remove ${name}`}
          icon={<Trash2 size={13} />}
          onClick={() => put(objects.filter((each) => each.name !== name))}
        />
      ),
    },
  ];
}

function isSame(one: string, other: string): boolean {
  return one.toLowerCase() === other.toLowerCase();
}
