/** Data that differed between two runs while they took equal steps. */

import type { DataChange } from "../../model/generated/protocol.ts";
import { shortValue } from "../../model/short_value.ts";
import { Table, type TableColumn } from "../../ui/table.tsx";
import type { ComparedSide, ShowCompared } from "./show.ts";

interface ChangedProps {
  readonly changed: readonly DataChange[];
  readonly show: ShowCompared;
}

const ROWS_MAX = 10;

export function Changed({ changed, show }: ChangedProps) {
  if (changed.length === 0) return <p className="compare-soft">All data is equal.</p>;
  const value = (side: ComparedSide, title: string): TableColumn<DataChange> => ({
    key: side,
    title,
    width: "minmax(90px, 2fr)",
    cell: (row) => (
      <button
        type="button"
        className="compare-value"
        title={`Show this moment in ${title.toLowerCase()}`}
        onClick={() => show(side, side === "one" ? row.one_sequence : row.other_sequence)}
      >
        {row[side] === null ? "none" : shortValue(row[side])}
      </button>
    ),
  });
  return (
    <Table
      label="Data that differed"
      columns={[
        {
          key: "names",
          title: "State",
          width: "minmax(110px, 2fr)",
          cell: ({ names }) => <span title={names}>{names.split("/").at(-1)}</span>,
        },
        {
          key: "port",
          title: "What",
          width: "minmax(90px, 1fr)",
          cell: ({ kind, port }) => (kind === "error" ? "error" : `${kind} ${port}`),
        },
        value("one", "This run"),
        value("other", "Other run"),
      ]}
      rows={changed}
      id={({ path, kind, port, one_sequence }) => `${path} ${kind} ${port} ${one_sequence}`}
      onOpen={(row) => show("one", row.one_sequence)}
      rowsMax={ROWS_MAX}
    />
  );
}
