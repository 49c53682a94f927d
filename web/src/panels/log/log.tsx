/** Log of the run, the page and the server, with the newest line at the end. A click shows the state and the moment of a line. */

import { computed, signal } from "@preact/signals-core";
import { ArrowUp } from "lucide-react";
import { useDeferredValue, useMemo, useState } from "react";
import type { ElementRef } from "../../model/element.ts";
import type { Watch } from "../../store/history/run.ts";
import { runLog } from "../../store/history/run_log.ts";
import { clearNotices } from "../../store/page/notices.ts";
import { type OpenTab, runOf } from "../../store/page/page.ts";
import { scriptLineRevealRequest } from "../../store/page/reveal_requests.ts";
import { RefusalError } from "../../store/page/server.ts";
import { runTime, runTimes, timeScale, wallTime } from "../../store/page/times.ts";
import { selectedStates } from "../../store/page/view.ts";
import { Button } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { isSameList, useComputed, useSignal } from "../../ui/signals.ts";
import { Table, type TableColumn } from "../../ui/table.tsx";
import { type PanelHost, useActiveTab, useHost } from "../context.tsx";
import { goTo } from "../go_to.ts";
import { reveal } from "../reveal.ts";
import { ChosenLine } from "./chosen_line.tsx";
import { inOneLine, type LogEntry, type LogSelection } from "./entries.ts";
import { FIRST_FILTER, LogBar } from "./log_bar.tsx";
import { useRows } from "./rows.ts";
import "./log.css";

const LIVE = signal<number | null>(null);

export function Log() {
  const host = useHost();
  const { page } = host.context();
  const tab = useActiveTab();
  const watch = useSignal(useMemo(() => computed(() => runOf(page)), [page]));
  const [filter, setFilter] = useState(FIRST_FILTER);
  const [chosen, setChosen] = useState<string | null>(null);
  const [, setCame] = useState(0);
  const selection = useLogSelection(tab, filter);
  const { rows, nameOf } = useRows(page, tab, watch, watch ? filter.source : "page", selection);
  const shown = useSignal(watch?.playhead ?? LIVE);
  const here = shown === null ? undefined : hereOf(rows, shown);
  useSignal(timeScale);
  const columns = useMemo(() => columnsOf(watch, nameOf), [watch, nameOf]);
  const entry = rows.find(({ id }) => id === chosen);
  const follow = (follows: boolean) =>
    setFilter((before) => (before.follows === follows ? before : { ...before, follows }));
  const choose = (next: LogEntry) => {
    follow(false);
    setChosen(next.id);
    show(host, tab, next);
  };
  const showMoment = (next: LogEntry) => {
    if (watch && next.line) watch.playhead.value = next.line.sequence;
  };
  return (
    <div className="log">
      <LogBar
        filter={filter}
        onChange={setFilter}
        hasRun={watch !== null}
        onClear={() => clearNotices(page)}
      >
        {watch && filter.source !== "page" && (
          <Older watch={watch} onCame={() => setCame((before) => before + 1)} />
        )}
      </LogBar>
      <div className="log-body">
        <div className="log-rows">
          {rows.length === 0 ? (
            <Nothing isFiltered={filter.query !== "" || filter.isOfSelection} />
          ) : (
            <Table
              label="Log"
              columns={columns}
              rows={rows}
              id={({ id }) => id}
              selected={new Set(chosen === null ? [] : [chosen])}
              onSelect={choose}
              onOpen={showMoment}
              follow={filter.follows && shown === null}
              onEnd={follow}
              inSight={here?.id}
              rowClass={(row) => (here ? classOf(row, here) : undefined)}
              hideHead
            />
          )}
        </div>
        {entry && (
          <ChosenLine
            entry={entry}
            watch={watch}
            stateName={entry.line ? nameOf(entry.line.path) : ""}
            onMoment={watch && (() => showMoment(entry))}
            onState={() => show(host, tab, entry)}
            onLine={(line) => showLine(host, tab, entry, line)}
            onClose={() => setChosen(null)}
          />
        )}
      </div>
    </div>
  );
}

function Nothing({ isFiltered }: { readonly isFiltered: boolean }) {
  return isFiltered ? (
    <Empty title="No matching lines" text="Remove part of the filter to see more." />
  ) : (
    <Empty
      title="The log is empty"
      text="Output, log messages and errors of states appear here. So do messages of the page: refused edits, saves, lost connections."
    />
  );
}

/** Button that loads earlier lines of the run, if there are any. */
function Older({ watch, onCame }: { readonly watch: Watch; readonly onCame: () => void }) {
  const { page } = useHost().context();
  const [isAsking, setAsking] = useState(false);
  const log = runLog(watch);
  useSignal(watch.journalVersion);
  if (log.from <= 1) return null;
  const ask = async () => {
    setAsking(true);
    try {
      await log.older(page.runs);
      onCame();
    } catch (error) {
      if (!(error instanceof RefusalError)) throw error;
      page.tell({ level: "warning", text: `Could not load older lines: ${error.message}` });
    } finally {
      setAsking(false);
    }
  };
  return (
    <Button
      kind="quiet"
      icon={<ArrowUp size={14} />}
      title={`Lines before event ${log.from.toLocaleString("en")} are not loaded`}
      disabled={isAsking}
      onClick={() => void ask()}
    >
      {isAsking ? "Loading…" : "Show older lines"}
    </Button>
  );
}

/** Filter of the log. Returns the cached object while it is unchanged. */
function useLogSelection(tab: OpenTab | null, filter: typeof FIRST_FILTER): LogSelection {
  const { least, isOfSelection } = filter;
  const query = useDeferredValue(filter.query);
  const states = useComputed(
    () => {
      const selected = tab && isOfSelection ? selectedStates(tab.view) : [];
      return selected.length === 0 ? null : selected;
    },
    [tab, isOfSelection],
    isSameList,
  );
  return useMemo(() => ({ least, query, states }), [least, query, states]);
}

/** Selects the subject of a line. */
function show(host: PanelHost, tab: OpenTab | null, { line, about }: LogEntry): void {
  const { page } = host.context();
  if (about && page.active.peek()?.session.id === about.machine) reveal(host, about.element);
  if (!line || line.path === "" || !tab) return;
  const element: ElementRef = { kind: "state", path: line.path };
  goTo(host, tab, element);
}

/** Shows a line of the state's script. */
function showLine(host: PanelHost, tab: OpenTab | null, entry: LogEntry, line: number): void {
  if (entry.line) scriptLineRevealRequest.value = { path: entry.line.path, line };
  show(host, tab, entry);
}

/** Last line before the shown moment. */
function hereOf(rows: readonly LogEntry[], shown: number): LogEntry | undefined {
  return rows.findLast(({ line }) => line !== undefined && line.sequence <= shown);
}

function classOf(row: LogEntry, here: LogEntry): string | undefined {
  if (row === here) return "log-here";
  const isLater =
    row.line && here.line ? row.line.sequence > here.line.sequence : row.at_ms > here.at_ms;
  return isLater ? "log-later" : undefined;
}

function columnsOf(
  watch: Watch | null,
  nameOf: (path: string) => string,
): readonly TableColumn<LogEntry>[] {
  const state: TableColumn<LogEntry> = {
    key: "state",
    title: "State",
    width: "minmax(80px, 160px)",
    cell: ({ line }) => (
      <span className="log-state" title={line?.path}>
        {line ? (line.path === "" ? "engine" : nameOf(line.path)) : "page"}
      </span>
    ),
  };
  return [timeColumn(watch), LEVEL, ...(watch ? [state] : []), TEXT];
}

function timeColumn(watch: Watch | null): TableColumn<LogEntry> {
  return {
    key: "time",
    title: "When",
    width: "minmax(100px, max-content)",
    align: "right",
    cell: ({ at_ms, line }) => (
      <span className="log-time" title={line && watch ? runTimes(watch, line.t_ns) : undefined}>
        {line && watch ? runTime(watch, line.t_ns) : wallTime(at_ms, Date.now())}
      </span>
    ),
  };
}

const LEVEL: TableColumn<LogEntry> = {
  key: "level",
  title: "Level",
  width: "70px",
  cell: ({ level }) => <span className={`log-${level}`}>{level}</span>,
};

const TEXT: TableColumn<LogEntry> = {
  key: "text",
  title: "Text",
  width: "minmax(0, 1fr)",
  cell: ({ text }) => <span title={text}>{inOneLine(text)}</span>,
};
