/** The statistics of a run, asked for again every few seconds while it goes on and somebody looks. */

import { type RefObject, useCallback, useEffect, useRef, useState } from "react";
import type { Statistics } from "../../model/generated/protocol.ts";
import type { Runs, Watch } from "../../store/run.ts";

const EVERY_MS = 3_000;

export interface Asked {
  readonly statistics: Statistics | null;
  readonly refusal: string | null;
  /** Asks now. */
  readonly refresh: () => void;
}

/** `place` is what has to be in sight. */
export function useStatistics(
  runs: Runs,
  watch: Watch,
  place: RefObject<HTMLElement | null>,
): Asked {
  const [found, setFound] = useState<Omit<Asked, "refresh">>({ statistics: null, refusal: null });
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
