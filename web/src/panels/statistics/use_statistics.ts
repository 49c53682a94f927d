/** Statistics of a run, refreshed every few seconds while the panel is visible and the run continues. For an earlier moment they
 * are computed here. */

import { type RefObject, useCallback, useEffect, useMemo, useRef, useState } from "react";
import type { Statistics } from "../../model/generated/protocol.ts";
import { lineage } from "../../model/path.ts";
import type { Runs, Watch } from "../../store/history/run.ts";
import { statisticsUntil } from "../../store/history/statistics_until.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { useSignal } from "../../ui/signals.ts";
import { namesOf } from "../parts/happened.ts";

const EVERY_MS = 3_000;

/** Statistics, and the last event that they include. */
export type Counted = Pick<Statistics, "states" | "sequence">;

interface RequestedStatistics {
  readonly statistics: Statistics | null;
  readonly refusal: string | null;
  /** Requests the statistics now. */
  readonly refresh: () => void;
}

/** `place` is the element that must be visible. */
export function useStatistics(
  runs: Runs,
  watch: Watch,
  place: RefObject<HTMLElement | null>,
): RequestedStatistics {
  const [found, setFound] = useState<Omit<RequestedStatistics, "refresh">>({
    statistics: null,
    refusal: null,
  });
  const isAsking = useRef(false);
  const refresh = useCallback(() => {
    if (isAsking.current) return;
    isAsking.current = true;
    runs
      .get<Statistics>(watch.id, "statistics")
      .then(
        (statistics) => setFound({ statistics, refusal: null }),
        (error: unknown) => {
          const refusal = error instanceof Error ? error.message : String(error);
          setFound(({ statistics }) => ({ statistics, refusal }));
        },
      )
      .finally(() => {
        isAsking.current = false;
      });
  }, [runs, watch]);
  const shown = found.statistics?.sequence ?? 0;
  useEffect(() => {
    const timer = setInterval(() => {
      const isSeen = !document.hidden && place.current?.offsetParent != null;
      if (isSeen && watch.journal.next - 1 > shown) refresh();
    }, EVERY_MS);
    return () => clearInterval(timer);
  }, [refresh, watch, shown, place]);
  useEffect(refresh, [refresh]);
  return { ...found, refresh };
}

/** Delay after the selection of a moment before the server computes its statistics, in ms. */
const SETTLED_MS = 300;

/** Statistics until the shown moment; null while live. For a long run the server computes them. */
export function useStatisticsUntil(tab: OpenTab, watch: Watch, runs: Runs): Counted | null {
  const { journal, playhead } = watch;
  const sequence = useSignal(playhead);
  const isLong = journal.base !== null;
  const there = useAsked(runs, watch, isLong ? sequence : null);
  const version = useSignal(tab.session.version);
  // biome-ignore lint/correctness/useExhaustiveDependencies: names change with the machine only
  const nameOf = useMemo(() => namesOf(tab.session), [tab.session, version]);
  const states = useMemo(() => {
    if (sequence === null || isLong) return null;
    const names = (path: string) => lineage(path).map(nameOf).join("/");
    const found = statisticsUntil(journal, journal.indexOf(sequence + 1));
    return found.map((row) => ({ ...row, names: names(row.path) }));
  }, [journal, sequence, isLong, nameOf]);
  if (sequence === null) return null;
  if (isLong) return there ?? { states: [], sequence };
  return states && { states, sequence };
}

/** Statistics from the server until an event. While they load, the previous ones are returned. */
function useAsked(runs: Runs, { id }: Watch, sequence: number | null): Counted | null {
  const [found, setFound] = useState<Counted | null>(null);
  useEffect(() => {
    if (sequence === null) return;
    let isGone = false;
    const timer = setTimeout(() => {
      runs.get<Statistics>(id, `statistics?until=${sequence}`).then(
        (statistics) => isGone || setFound({ states: statistics.states, sequence }),
        () => isGone || setFound(null),
      );
    }, SETTLED_MS);
    return () => {
      isGone = true;
      clearTimeout(timer);
    };
  }, [runs, id, sequence]);
  return found;
}
