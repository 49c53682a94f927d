/** List of differences. Below it, the selected one is shown with both full values. */

import { useState } from "react";
import type { Difference } from "../model/difference.ts";
import { keyOf } from "../model/element.ts";
import type { Machine } from "../model/machine.ts";
import type { FieldChange } from "../model/state_fields.ts";
import { onDemand } from "../ui/on_demand.tsx";
import { Table, type TableColumn } from "../ui/table.tsx";
import { KIND_WORDS, summary, whereabouts } from "./difference_words.ts";
import "./difference_list.css";

const TextDifference = onDemand(
  async () => (await import("../ui/text_difference.tsx")).TextDifference,
);

interface DifferenceListProps {
  readonly label: string;
  readonly all: readonly Difference[];
  /** Machine that names the removed elements. */
  readonly old: Machine;
  readonly now: Machine;
  readonly onReveal: (difference: Difference) => void;
}

const MARKS = { added: "+ added", removed: "− removed", changed: "~ changed" } as const;

function idOf({ kind, element, isLayout }: Difference): string {
  return `${kind} ${keyOf(element)} ${isLayout}`;
}

export function DifferenceList({ label, all, old, now, onReveal }: DifferenceListProps) {
  const [chosen, setChosen] = useState<string | null>(null);
  const difference =
    all.find((each) => idOf(each) === chosen) ?? (all.length === 1 ? all[0] : undefined);
  const columns: readonly TableColumn<Difference>[] = [
    {
      key: "kind",
      title: "",
      width: "104px",
      cell: ({ kind }) => (
        <span className={`differences-mark differences-${kind}`}>{MARKS[kind]}</span>
      ),
    },
    {
      key: "name",
      title: "What",
      cell: ({ element, name }) => (
        <>
          <span className="differences-soft">{KIND_WORDS[element.kind]} </span>
          {name}
        </>
      ),
    },
    { key: "summary", title: "Difference", cell: summary },
    {
      key: "where",
      title: "Where",
      cell: (each) => (
        <span className="differences-soft">
          {whereabouts(each.kind === "removed" ? old : now, each)}
        </span>
      ),
    },
  ];
  return (
    <div className="differences-list">
      <div className="differences-sides">
        <div className="differences-rows">
          <Table
            label={label}
            columns={columns}
            rows={all}
            id={idOf}
            selected={new Set(difference ? [idOf(difference)] : [])}
            onSelect={(each) => {
              setChosen(idOf(each));
              onReveal(each);
            }}
          />
        </div>
        {difference && difference.fields.length > 0 && <Detail difference={difference} />}
      </div>
    </div>
  );
}

function Detail({ difference }: { difference: Difference }) {
  const { fields, name, element } = difference;
  const lines = fields.filter(({ isText }) => !isText);
  return (
    <section className="differences-detail" aria-label={`Differences of ${name}`}>
      <h4>
        {KIND_WORDS[element.kind]} {name}
      </h4>
      {lines.length > 0 && (
        <dl className="differences-field">
          {lines.map((field) => (
            <Line key={field.field} change={field} />
          ))}
        </dl>
      )}
      {fields
        .filter(({ isText }) => isText)
        .map(({ field, old, now }) => (
          <div key={field} className="differences-text">
            <div className="differences-soft">{field}</div>
            <TextDifference
              label={`${field} of ${name}, old and new`}
              old={old}
              now={now}
              isPython={field === "script"}
            />
          </div>
        ))}
    </section>
  );
}

function Line({ change: { field, old, now } }: { change: FieldChange }) {
  return (
    <>
      <dt>{field}</dt>
      <dd>
        <del>{old === "" ? "nothing" : old}</del> → <ins>{now === "" ? "nothing" : now}</ins>
      </dd>
    </>
  );
}
