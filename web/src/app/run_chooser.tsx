/** State of the current run in a word, and a menu with the other runs of its machine. */

import { ChevronDown } from "lucide-react";
import { useRef, useState } from "react";
import type { CommandMenuEntry } from "../commands/menus.ts";
import type { RunSummary } from "../model/generated/protocol.ts";
import { isLive, runStatusWords, statusInWords, summaryStatusWords } from "../model/run_words.ts";
import { agePhrase } from "../panels/parts/age.ts";
import { duration, growing } from "../panels/parts/duration.ts";
import { RunStatusView } from "../panels/parts/run_status_mark.tsx";
import { useRunAge } from "../panels/run_age.ts";
import type { Watch } from "../store/history/run.ts";
import type { OpenTab } from "../store/page/page.ts";
import { startedAt } from "../store/page/times.ts";
import { elapsedAtDataEnd } from "../store/run/data_end.ts";
import { runsOfTab } from "../store/run/running.ts";
import { ContextMenu } from "../ui/menu.tsx";
import { isSameRecord, useComputed, useSignal } from "../ui/signals.ts";
import { useEntries } from "./entries.ts";
import { useSession } from "./session_context.tsx";

/** Number of runs in the menu; the panel lists all. */
const RUNS_MAX = 12;

export function RunChooser({ tab }: { tab: OpenTab }) {
  const { page } = useSession();
  const place = useRef<HTMLButtonElement>(null);
  const [at, setAt] = useState<{ x: number; y: number } | null>(null);
  const watch = useSignal(tab.run);
  const count = useComputed(() => runsOfTab(page, tab).length, [page, tab]);
  const items = useRuns(tab);
  if (!watch && count === 0) return null;
  const open = () => {
    const box = place.current?.getBoundingClientRect();
    if (box) setAt({ x: box.left, y: box.bottom + 2 });
  };
  return (
    <>
      <button ref={place} type="button" className="run-chooser" aria-haspopup="menu" onClick={open}>
        {watch ? (
          <RunStatusMark watch={watch} />
        ) : (
          <span>{count === 1 ? "1 run" : `${count} runs`}</span>
        )}
        <ChevronDown size={14} aria-hidden />
      </button>
      {watch && <Announced watch={watch} />}
      {at && <ContextMenu label="runs" at={at} items={items()} onClose={() => setAt(null)} />}
    </>
  );
}

/** Announces changes of the run's state to screen readers, without its length. */
function Announced({ watch }: { watch: Watch }) {
  const text = useComputed(() => {
    const now = watch.now.value;
    return now ? `Run ${statusInWords(runStatusWords(now))}` : "";
  }, [watch]);
  return (
    <span className="visually-hidden" role="status">
      {text}
    </span>
  );
}

/** The word, what belongs to it, and how long. */
function RunStatusMark({ watch }: { watch: Watch }) {
  const { page } = useSession();
  const status = useComputed(
    () => {
      const now = watch.now.value;
      return now && runStatusWords(now);
    },
    [watch],
    isSameRecord,
  );
  const elapsed = useComputed(() => {
    const now = watch.now.value;
    const isTicking = now !== null && isLive(now.run.phase);
    const ms = elapsedAtDataEnd(page, watch);
    return isTicking ? growing(ms) : duration(ms);
  }, [page, watch]);
  const { isOld, age_ms } = useRunAge(page, watch);
  if (status === null) return <span>Run …</span>;
  return (
    <span className={`run-chooser-status shows-run ${isOld ? "is-old" : ""}`}>
      <span className="visually-hidden">Run:</span>
      <RunStatusView status={status} />
      <span className="run-elapsed">{elapsed}</span>
      {isOld && <span className="run-elapsed">{agePhrase(age_ms)} old</span>}
    </span>
  );
}

function useRuns(tab: OpenTab): () => readonly CommandMenuEntry[] {
  const { page, commands, context } = useSession();
  const more = useEntries(["run.show-as-ran", "run.leave", "run.follow"]);
  const entry = (run: RunSummary): CommandMenuEntry => ({
    id: run.id,
    title: `${startedAt(run)}  ${statusInWords(summaryStatusWords(run))}`,
    detail: run.author === null ? run.id : `${run.id}, started by ${run.author}`,
    checked: tab.run.value?.id === run.id,
    run: () => void commands.run("run.show", context(), run.id),
  });
  const all: CommandMenuEntry = {
    id: "all runs",
    title: "All runs…",
    run: () => context().shell.showPanel("runs"),
  };
  return () => {
    const runs = runsOfTab(page, tab).slice(0, RUNS_MAX).map(entry);
    return [...runs, "separator", ...more(), "separator", all];
  };
}
