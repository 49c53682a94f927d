/** Statistics of the states of a run: number of visits, durations, and outcomes. */

import { Flame, RefreshCw } from "lucide-react";
import { type RefObject, useLayoutEffect, useMemo, useRef, useState } from "react";
import type { StateStatistics } from "../../model/generated/protocol.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Table, type TableColumn } from "../../ui/table.tsx";
import { useCommand, useHost } from "../context.tsx";
import { measured } from "../parts/duration.ts";
import { forRun, type RunPanelProps } from "../parts/for_tab.tsx";
import { reveal } from "../reveal.ts";
import { rowsOf, type Sort, scaleOf, sortedBy } from "./rows.ts";
import { type Counted, useStatistics, useStatisticsUntil } from "./use_statistics.ts";
import "./statistics.css";

export const Statistics = forRun(
  StatisticsOfRun,
  <Empty
    title="No run is shown"
    text="Start a run or open one in Runs to see how often its states ran, how long, and how they ended."
  />,
);

function StatisticsOfRun({ tab, watch }: RunPanelProps) {
  const host = useHost();
  const command = useCommand();
  const place = useRef<HTMLDivElement>(null);
  const { page } = host.context();
  const whole = useStatistics(page.runs, watch, place);
  const past = useStatisticsUntil(tab, watch, page.runs);
  const statistics = past ?? whole.statistics;
  const refusal = past ? null : whole.refusal;
  const [query, setQuery] = useState("");
  const heat = useSignal(tab.view.heat);
  const isNarrow = useNarrow(place);
  return (
    <div className="statistics" ref={place}>
      <div className="statistics-bar">
        <TextField
          label="Filter states"
          hideLabel
          type="search"
          placeholder="Filter by state or outcome"
          value=""
          onInput={setQuery}
        />
        <span className="statistics-fact">{factOf(statistics, past !== null)}</span>
        <Button
          kind="quiet"
          icon={<Flame size={14} />}
          pressed={heat !== "off"}
          title="Colour the states on the canvas by how long they ran"
          onClick={() => command("view.heat", heat === "off" ? "time" : "off")}
        >
          Heat on the canvas
        </Button>
        <IconButton
          label="Count again"
          icon={<RefreshCw size={14} />}
          disabled={past !== null}
          onClick={whole.refresh}
        />
      </div>
      {refusal !== null && <p className="statistics-refusal">{refusal}</p>}
      {statistics && (
        <Rows tab={tab} states={statistics.states} query={query} isNarrow={isNarrow} />
      )}
    </div>
  );
}

function factOf(statistics: Counted | null, isPast: boolean): string {
  if (!statistics) return "counting…";
  const { states, sequence } = statistics;
  const many = `${states.length.toLocaleString("en")} ${states.length === 1 ? "state" : "states"}`;
  return isPast
    ? `${many}, up to this moment`
    : `${many}, up to event ${sequence.toLocaleString("en")}`;
}

interface StatisticsRowsProps {
  readonly tab: OpenTab;
  readonly states: readonly StateStatistics[];
  readonly query: string;
  readonly isNarrow: boolean;
}

function Rows({ tab, states, query, isNarrow }: StatisticsRowsProps) {
  const host = useHost();
  const selection = useSignal(tab.view.selection);
  const [sort, setSort] = useState<Sort>({ key: "total", down: true });
  const rows = useMemo(() => rowsOf(states, query, sort), [states, query, sort]);
  const columns = useMemo(() => columnsOf(states, isNarrow), [states, isNarrow]);
  const selected = new Set(
    rows.flatMap(({ path }) => (selection.has(`state:${path}`) ? [path] : [])),
  );
  if (rows.length === 0) {
    const text = states.length === 0 ? "No state has ended yet." : "No state matches the filter.";
    return <p className="statistics-none">{text}</p>;
  }
  return (
    <div className="statistics-table">
      <Table
        label="Statistics of the run"
        columns={columns}
        rows={rows}
        id={({ path }) => path}
        sort={sort}
        onSort={(key) => setSort(sortedBy(sort, key))}
        selected={selected}
        onSelect={({ path }) => reveal(host, { kind: "state", path })}
        onHover={(row) => {
          tab.view.hovered.value = row ? { kind: "state", path: row.path } : null;
        }}
      />
    </div>
  );
}

/** Width below which the least important columns are hidden, in CSS pixels. */
const NARROW_PX = 720;

function useNarrow(place: RefObject<HTMLElement | null>): boolean {
  const [isNarrow, setNarrow] = useState(false);
  useLayoutEffect(() => {
    const element = place.current;
    if (!element) return;
    const sizes = new ResizeObserver(() => setNarrow(element.clientWidth < NARROW_PX));
    sizes.observe(element);
    return () => sizes.disconnect();
  }, [place]);
  return isNarrow;
}

function columnsOf(
  states: readonly StateStatistics[],
  isNarrow: boolean,
): readonly TableColumn<StateStatistics>[] {
  const all = allColumns(states);
  return isNarrow ? all.filter(({ key }) => key !== "min" && key !== "spread") : all;
}

function allColumns(states: readonly StateStatistics[]): readonly TableColumn<StateStatistics>[] {
  const scale = scaleOf(states);
  const time = (key: string, title: string, ns: (row: StateStatistics) => number) =>
    ({
      key,
      title,
      width: "68px",
      align: "right",
      sortable: true,
      cell: (row: StateStatistics) => measured(ns(row) / 1e6),
    }) as const;
  return [
    {
      key: "names",
      title: "State",
      width: "minmax(120px, 2fr)",
      sortable: true,
      cell: ({ names }) => <Names names={names} />,
    },
    {
      key: "count",
      title: "Count",
      width: "64px",
      align: "right",
      sortable: true,
      cell: ({ count }) => count.toLocaleString("en"),
    },
    time("total", "Total", ({ total_ns }) => total_ns),
    time("min", "Min", ({ min_ns }) => min_ns),
    time("median", "Median", ({ median_ns }) => median_ns),
    time("p95", "95 %", ({ p95_ns }) => p95_ns),
    time("max", "Max", ({ max_ns }) => max_ns),
    {
      key: "spread",
      title: "Spread",
      width: "minmax(70px, 0.8fr)",
      cell: (row) => <Spread row={row} scale={scale} />,
    },
    {
      key: "outcomes",
      title: "Outcomes",
      width: "minmax(110px, 1.4fr)",
      cell: (row) => <Outcomes row={row} />,
    },
  ];
}

/** Name, followed by the names around it, which are cut first. */
function Names({ names }: { names: string }) {
  const parts = names.split("/");
  const around = parts.slice(0, -1).join(" / ");
  return (
    <span title={parts.join(" / ")}>
      {parts.at(-1)} <span className="statistics-faint">{around}</span>
    </span>
  );
}

interface SpreadProps {
  readonly row: StateStatistics;
  readonly scale: (ns: number) => number;
}

/** Durations from the shortest to the longest, thick up to the 95th percentile, with a mark at the median, on a logarithmic scale. */
function Spread({ row, scale }: SpreadProps) {
  const percent = (ns: number) => `${(scale(ns) * 100).toFixed(1)}%`;
  const words = `from ${measured(row.min_ns / 1e6)} to ${measured(row.max_ns / 1e6)}, half within ${measured(row.median_ns / 1e6)}`;
  return (
    <svg className="statistics-spread" role="img" aria-label={words}>
      <title>{words}</title>
      <line x1={percent(row.min_ns)} x2={percent(row.max_ns)} y1="50%" y2="50%" />
      <line
        className="statistics-most"
        x1={percent(row.min_ns)}
        x2={percent(row.p95_ns)}
        y1="50%"
        y2="50%"
      />
      <circle cx={percent(row.median_ns)} cy="50%" r={3} />
    </svg>
  );
}

function Outcomes({ row: { outcomes } }: { row: StateStatistics }) {
  const words = outcomes
    .map(({ outcome, count }) => `${outcome.name} ${count.toLocaleString("en")}`)
    .join(", ");
  return (
    <span title={words}>
      {outcomes.map(({ outcome, count }, index) => (
        <span key={outcome.id} className={classOf(outcome.id)}>
          {index > 0 ? ", " : ""}
          {outcome.name} {count.toLocaleString("en")}
        </span>
      ))}
    </span>
  );
}

function classOf(outcome: number): string | undefined {
  if (outcome === -1) return "statistics-aborted";
  return outcome === -2 ? "statistics-preempted" : undefined;
}
