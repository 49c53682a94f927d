/** Lines that the log shows: of the page and of the current run, sorted by time. */

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

/** Refresh interval of the log, in ms. */
const PACE_MS = 250;

const NEVER = signal(0);
const LIVE = signal<number | null>(null);
const NONE: readonly LogEntry[] = [];

export interface Rows {
  readonly rows: readonly LogEntry[];
  /** Name of a state in the log. */
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

/** Start of the run by this browser's clock. It is fixed at the first use, so that lines do not move when clocks are compared again. */
function useBegan(page: Page, watch: Watch | null): number | null {
  const started_ms = useSignal(
    useMemo(() => computed(() => watch?.now.value?.run.started_ms ?? null), [watch]),
  );
  return useMemo(
    () => started_ms && started_ms - (page.server.pulse.peek()?.ahead_ms ?? 0),
    [started_ms, page],
  );
}
