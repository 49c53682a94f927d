/** All runs of the server, the newest first, each with its status and actions. */

import { signal } from "@preact/signals-core";
import { MoreVertical, RefreshCw } from "lucide-react";
import { memo, useState } from "react";
import { lacks } from "../../commands/run_rules.ts";
import type { RunSummary } from "../../model/generated/protocol.ts";
import { isLive, summaryStatusWords } from "../../model/run_words.ts";
import { startedAt, timeScale } from "../../store/page/times.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { TextField } from "../../ui/field.tsx";
import { ContextMenu, type MenuItem } from "../../ui/menu.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useActiveTab, useCommand, useHost } from "../context.tsx";
import { useAssumed } from "../parts/assumed.ts";
import { duration } from "../parts/duration.ts";
import { RunStatusView } from "../parts/run_status_mark.tsx";
import { useIsOld } from "../run_age.ts";
import { foundRuns } from "./found.ts";
import "./runs.css";

const NO_RUN = signal(null);

/** Number of rows at first, and of rows that each click adds. */
const STEP = 100;

export function Runs() {
  const { page } = useHost().context();
  const all = useSignal(page.runs.all);
  const [search, setSearch] = useState("");
  const [most, setMost] = useState(STEP);
  const found = foundRuns(all, search);
  if (all.length === 0) {
    return (
      <Empty
        title="No runs yet"
        text="Start the open machine: its run is kept here with its full history."
      />
    );
  }
  return (
    <div className="runs">
      <div className="runs-bar">
        <TextField
          label="Find runs"
          hideLabel
          type="search"
          placeholder="Name, outcome, author, …"
          value=""
          onInput={setSearch}
        />
        <IconButton
          label="Check for runs started elsewhere"
          icon={<RefreshCw size={14} />}
          onClick={() => void page.runs.refresh()}
        />
      </div>
      {found.length === 0 && <p className="runs-none">No run matches.</p>}
      <ul className="runs-list" aria-label="Runs">
        {found.slice(0, most).map((run) => (
          <Row key={run.id} run={run} />
        ))}
        {found.length > most && (
          <li className="runs-more">
            <Button onClick={() => setMost(most + STEP)}>
              Show more of {found.length.toLocaleString("en")}
            </Button>
          </li>
        )}
      </ul>
    </div>
  );
}

/** Row that ignores the length and size of an active run, which change all the time and are not displayed. */
const Row = memo(RunRow, (one, other) => rowText(one.run) === rowText(other.run));

function rowText(run: RunSummary): string {
  const { word, detail } = summaryStatusWords(run);
  const silentSince_ms = run.unheard_since_ms ?? "";
  return `${run.id} ${run.name} ${word} ${detail} ${silentSince_ms} ${isLive(run.phase) ? "" : run.length_ms}`;
}

function RunRow({ run }: { run: RunSummary }) {
  const command = useCommand();
  const tab = useActiveTab();
  const watch = useShownRun(tab);
  const [menu, setMenu] = useState<{ x: number; y: number } | null>(null);
  const items = useItems(run, watch);
  useSignal(timeScale);
  const status = summaryStatusWords(run);
  const assumed = useAssumed(run);
  const started = startedAt(run);
  const by = run.author === null ? "" : ` · ${run.author}`;
  const isShown = watch === run.id;
  const isOld = useMayBeOld(run, isShown);
  return (
    <li
      className={`runs-row ${isShown ? "runs-row-shown" : ""} ${isOld ? "shows-run is-old" : ""}`}
      aria-current={isShown}
      onContextMenu={(event) => {
        event.preventDefault();
        setMenu({ x: event.clientX, y: event.clientY });
      }}
    >
      <button
        type="button"
        className="runs-open"
        title={`${run.id}${status.detail === "" ? "" : `: ${status.detail}`}`}
        onClick={() => command("run.show", run.id)}
      >
        <span className="runs-name">{run.name}</span>
        <RunStatusView status={status} assumed={assumed} />
        <span className="runs-when">
          {started}
          {isLive(run.phase) ? "" : ` · ${duration(run.length_ms)}`}
          {by}
        </span>
      </button>
      <IconButton
        label={`Actions for the run ${run.id}`}
        icon={<MoreVertical size={14} />}
        onClick={(event) => {
          const box = event.currentTarget.getBoundingClientRect();
          setMenu({ x: box.left, y: box.bottom });
        }}
      />
      {menu && (
        <ContextMenu label={run.id} at={menu} items={items()} onClose={() => setMenu(null)} />
      )}
    </li>
  );
}

/** True if the status of an active run may be outdated: the server is not connected, or its program does not respond. */
function useMayBeOld(run: RunSummary, isShown: boolean): boolean {
  const { page } = useHost().context();
  const isOldInFront = useIsOld(page);
  const isDown = useSignal(page.server.link).state !== "up";
  const isUnheard = run.unheard_since_ms !== undefined;
  return isLive(run.phase) && (isDown || isUnheard || (isShown && isOldInFront));
}

function useShownRun(tab: ReturnType<typeof useActiveTab>): string | null {
  const { page } = useHost().context();
  useSignal(page.active);
  return useSignal(tab?.run ?? NO_RUN)?.id ?? null;
}

function useItems(run: RunSummary, inFront: string | null): () => readonly MenuItem[] {
  const command = useCommand();
  const { page } = useHost().context();
  const refusal = isLive(run.phase)
    ? "the run is active: stop it first"
    : lacks(page, "administer");
  const item = (id: string, title: string, act: () => void) => ({ id, title, run: act });
  return () => [
    item("show", "Show", () => command("run.show", run.id)),
    item("ran", "Show the machine as it ran", () => command("run.show-as-ran", run.id)),
    {
      ...item("compare", "Compare with the current run", () => command("run.compare", run.id)),
      disabled: inFront === null || inFront === run.id,
    },
    "separator",
    ...EXPORTS.map((format) =>
      item(format, `Export as ${format.toUpperCase()}`, () =>
        command("run.export", { run: run.id, format }),
      ),
    ),
    "separator",
    {
      id: "delete",
      title: "Delete…",
      disabled: refusal !== null,
      detail: refusal ?? undefined,
      run: () => command("run.delete", run.id),
    },
  ];
}

const EXPORTS = ["jsonl", "csv", "mcap"] as const;
