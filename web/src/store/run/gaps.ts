/** Periods of a run without news: no connection to the server, none between server and run, or no response from the run's program.
 * Their events arrived later. At a station, also the data that it does not have yet. */

import { effect, type ReadonlySignal, signal, untracked } from "@preact/signals-core";
import type { RunNow } from "../../model/generated/protocol.ts";
import { perOwner } from "../../model/per_owner.ts";
import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import { extent_ns } from "./data_end.ts";

export interface Gap {
  /** In ns since the start of the run. */
  readonly from_ns: number;
  /** Null while the gap is open. */
  readonly to_ns: number | null;
}

type GapSource = Pick<Watch, "now" | "journal" | "proven_ms" | "isCurrent" | "whenClosed">;
type GapPage = { readonly server: Pick<Page["server"], "link" | "pulse"> };

/** Capacity. Beyond it the two oldest gaps are merged, because periods without news must stay marked. */
const GAPS_MAX = 200;

/** Gaps since the first request. A gap ends with the first status received after it. */
export const gapsOf = perOwner(
  (watch: GapSource, page: GapPage): ReadonlySignal<readonly Gap[]> => {
    const gaps = signal<readonly Gap[]>([]);
    let before: RunNow | null = null;
    const stop = effect(() => {
      const now = watch.now.value;
      // The link of a finished run is not followed, because nothing updates it after the page has left the run.
      const isLive = now?.run.phase === "live";
      const isAway = isLive && (page.server.link.value.state !== "up" || now.link !== "up");
      const last = gaps.peek().at(-1);
      const open = last?.to_ns === null ? last : null;
      if (isAway && !open) {
        before = now;
        gaps.value = bounded([
          ...gaps.peek(),
          { from_ns: untracked(() => extent_ns(page, watch)), to_ns: null },
        ]);
      } else if (!isAway && open && now !== before) {
        gaps.value = gaps
          .peek()
          .with(-1, { ...open, to_ns: untracked(() => extent_ns(page, watch)) });
      }
    });
    watch.whenClosed(stop);
    return gaps;
  },
);

function bounded(gaps: readonly Gap[]): readonly Gap[] {
  const [first, second, ...others] = gaps;
  if (gaps.length <= GAPS_MAX || !first || !second) return gaps;
  return [{ from_ns: first.from_ns, to_ns: second.to_ns }, ...others];
}

/** Data that a robot has recorded and its station does not have yet: from the end of the history to the state that arrived ahead of
 * it. */
export function lackingOf({ now, journal }: Pick<GapSource, "now" | "journal">): readonly Gap[] {
  const status = now.value;
  if (!status?.robot?.missing) return [];
  const from_ns = journal.length > 0 ? journal.t_ns(journal.length - 1) : 0;
  const to_ns = (status.snapshot?.elapsed_ms ?? 0) * 1e6;
  return to_ns > from_ns ? [{ from_ns, to_ns }] : [];
}
