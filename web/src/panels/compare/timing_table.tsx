/** Table of the durations of states in two runs, sortable by column. */

import { useMemo, useState } from "react";
import type { Timing } from "../../model/generated/protocol.ts";
import { callsOf } from "../../store/history/calls.ts";
import type { Watch } from "../../store/history/run.ts";
import { Table, type TableColumn } from "../../ui/table.tsx";
import { useHost } from "../context.tsx";
import { measured } from "../parts/duration.ts";
import type { ComparedSide, ShowCompared } from "./show.ts";
import { sorted, type TimingOrder, type TimingRow, timingRows } from "./timing.ts";

interface TimingTableProps {
  readonly watch: Watch;
  readonly other: string;
  readonly timing: readonly Timing[];
  readonly show: ShowCompared;
}

const ROWS_MAX = 16;

export function TimingTable({ watch, other, timing, show }: TimingTableProps) {
  const { page } = useHost().context();
  const [sort, setSort] = useState<{ key: TimingOrder; down: boolean }>({
    key: "more",
    down: true,
  });
  const rows = useMemo(() => timingRows(timing), [timing]);
  const shown = useMemo(() => sorted(rows, sort.key, sort.down), [rows, sort]);
  const showFirst = (side: ComparedSide, { path }: TimingRow) => {
    const { journal } = side === "one" ? watch : page.runs.watch(other);
    const calls = callsOf(journal);
    const [first] = calls.of(path);
    if (first !== undefined) show(side, journal.sequence(calls.begin(first)));
  };
  return (
    <Table
      label="Time in states, in both runs"
      columns={columnsOf(showFirst)}
      rows={shown}
      id={({ path }) => path}
      sort={sort}
      onSort={(key) =>
        setSort((before) => ({
          key: key as TimingOrder,
          down: before.key === key ? !before.down : key !== "names",
        }))
      }
      onOpen={(row) => showFirst("one", row)}
      rowsMax={ROWS_MAX}
    />
  );
}

function columnsOf(
  show: (side: ComparedSide, row: TimingRow) => void,
): readonly TableColumn<TimingRow>[] {
  const mean = (side: ComparedSide, title: string): TableColumn<TimingRow> => ({
    key: side,
    title,
    width: "minmax(84px, 1fr)",
    align: "right",
    sortable: true,
    cell: (row) => {
      const { count, mean_ms } = row[side];
      if (mean_ms === null) return <span className="compare-soft">never</span>;
      return (
        <button
          type="button"
          className="compare-value compare-time"
          title={`Average of ${count} times: show the first in ${title.toLowerCase()}`}
          onClick={() => show(side, row)}
        >
          {measured(mean_ms)}
        </button>
      );
    },
  });
  return [
    {
      key: "names",
      title: "State",
      width: "minmax(120px, 2fr)",
      sortable: true,
      cell: ({ names }) => <span title={names}>{names.split("/").at(-1)}</span>,
    },
    {
      key: "counts",
      title: "Times",
      width: "84px",
      align: "right",
      sortable: true,
      cell: ({ one, other }) =>
        one.count === other.count ? one.count : `${one.count} | ${other.count}`,
    },
    mean("one", "This run"),
    mean("other", "Other run"),
    {
      key: "more",
      title: "Longer by",
      width: "minmax(84px, 1fr)",
      align: "right",
      sortable: true,
      cell: ({ more_ms }) => (more_ms === null ? "" : measured(more_ms)),
    },
  ];
}
