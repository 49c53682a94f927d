/** Texts about the time of an event in a run. */

import { isLive } from "../../model/run_words.ts";
import type { Watch } from "../../store/history/run.ts";
import { elapsedAtDataEnd } from "../../store/run/data_end.ts";
import { useComputed } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { duration, growing } from "../parts/duration.ts";

/** Time since the event, by the clock of the run. After the end of the run, the time between its start and the event. */
export function useWhen(watch: Watch, t_ms: number): string {
  const { page } = useHost().context();
  return useComputed(() => {
    const now = watch.now.value;
    if (!now || !isLive(now.run.phase)) return `after ${growing(t_ms)}`;
    const ago_ms = elapsedAtDataEnd(page, watch) - t_ms;
    const ago_s = Math.max(0, Math.floor(ago_ms / 1_000));
    return `${ago_s < 60 ? `${ago_s} s` : duration(ago_s * 1_000)} ago`;
  }, [page, watch, t_ms]);
}
