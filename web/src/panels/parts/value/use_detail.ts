/** An event of a run with its values. While it loads, the previous one is returned. */

import { useEffect, useRef, useState } from "react";
import type { EventDetail } from "../../../model/generated/protocol.ts";
import { eventDetail } from "../../../store/history/event_details.ts";
import type { Runs } from "../../../store/history/run.ts";

export interface Detailed {
  /** Newest loaded event; null before the first. */
  readonly detail: EventDetail | null;
  /** Reason why the requested event is unavailable. */
  readonly refusal: string | null;
}

const NOTHING: Detailed = { detail: null, refusal: null };

/** Requests the event, or none if `sequence` is null. Earlier requests stay valid until the newest one has loaded. Otherwise
 * values that change faster than they load would never be updated. */
export function useDetail(runs: Runs, run: string, sequence: number | null): Detailed {
  const [found, setFound] = useState(NOTHING);
  const order = useRef({ asked: 0, shown: 0 });
  useEffect(() => {
    if (sequence === null) return;
    const counts = order.current;
    counts.asked += 1;
    const place = counts.asked;
    const isNews = () => {
      if (place <= counts.shown) return false;
      counts.shown = place;
      return true;
    };
    eventDetail(runs, run, sequence).then(
      (detail) => {
        if (isNews()) setFound({ detail, refusal: null });
      },
      (error: unknown) => {
        const refusal = error instanceof Error ? error.message : String(error);
        if (place === counts.asked && isNews()) setFound(({ detail }) => ({ detail, refusal }));
      },
    );
  }, [runs, run, sequence]);
  return found;
}
