/** The lines that the log shows: of the page and of the run in front, by time. */

import { computed, signal } from "@preact/signals-core";
import { useCallback, useMemo } from "react";
import { idOf } from "../../model/path.ts";
import type { Watch } from "../../store/history/run.ts";
import { runLog } from "../../store/history/run_log.ts";
import type { OpenTab, Page } from "../../store/page/page.ts";
import { useSignal } from "../../ui/signals.ts";
import { useThrottled } from "../../ui/throttled.ts";
import {
  entryOf,
  isWanted,
  type LogEntry,
  type LogSelection,
  type LogSource,
  merged,
} from "./entries.ts";
import { Sieve } from "./sieve.ts";

/** Nobody reads faster. */
const PACE_MS = 250;

const NEVER = signal(0);
const LIVE = signal<number | null>(null);
const NONE: readonly LogEntry[] = [];

export interface Rows {
  readonly rows: readonly LogEntry[];
  /** How the log calls a state. */
  readonly nameOf: (path: string) => string;
}

export function useRows(
  page: Page,
  tab: OpenTab | null,
  watch: Watch | null,
  source: LogSource,
  selection: LogSelection,
): Rows {
  const notices = useSignal(page.notices);
  useThrottled(watch?.journalVersion ?? NEVER, PACE_MS);
  const nameOf = useCallback(
    (path: string) => tab?.session.machine.state(path)?.name ?? idOf(path),
    [tab],
  );
  const ofPage = useMemo(() => {
    if (source === "run") return NONE;
    const kept = notices.filter(({ passing }) => !passing);
    return kept.map(entryOf).filter((entry) => isWanted(entry, selection, nameOf));
  }, [notices, source, selection, nameOf]);
  const began_ms = useBegan(page, watch);
  useSignal(watch?.playhead ?? LIVE);
  const log = watch && runLog(watch);
  const sieve = useMemo(() => {
    if (!log || source === "page" || began_ms === null) return null;
    return new Sieve(log, selection, began_ms, nameOf);
  }, [log, source, selection, began_ms, nameOf]);
  const ofRun = sieve?.rows() ?? NONE;
  const rows = useMemo(() => merged(ofRun, ofPage), [ofRun, ofPage]);
  return { rows, nameOf };
}

/** When the run began, by this browser's clock as it was when that was asked for: lines do not move when the clocks are compared. */
function useBegan(page: Page, watch: Watch | null): number | null {
  const started_ms = useSignal(
    useMemo(() => computed(() => watch?.now.value?.run.started_ms ?? null), [watch]),
  );
  return useMemo(
    () => started_ms && started_ms - (page.server.pulse.peek()?.ahead_ms ?? 0),
    [started_ms, page],
  );
}
