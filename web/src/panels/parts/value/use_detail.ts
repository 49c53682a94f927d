/** One event of a run with its values, while it is on its way the one before. */

import { useEffect, useRef, useState } from "react";
import type { EventDetail } from "../../../model/generated/protocol.ts";
import { eventDetail } from "../../../store/history/event_details.ts";
import type { Runs } from "../../../store/history/run.ts";

export interface Detailed {
  /** The newest that came; null before the first. */
  readonly detail: EventDetail | null;
  /** Why the wanted one did not come. */
  readonly refusal: string | null;
}

const NOTHING: Detailed = { detail: null, refusal: null };

/** Asks for the event; null wants none. What was asked for before counts until the newest has come: else values that change faster
 * than they are told would never be others. */
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
