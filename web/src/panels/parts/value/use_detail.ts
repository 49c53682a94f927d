/** One event of a run with its values, while it is on its way the one before. */

import { useEffect, useState } from "react";
import type { EventDetail } from "../../../model/generated/protocol.ts";
import { eventDetail } from "../../../store/event_details.ts";
import type { Runs } from "../../../store/run.ts";

export interface Detailed {
  /** The newest that came; null before the first. */
  readonly detail: EventDetail | null;
  /** Why the wanted one did not come. */
  readonly refusal: string | null;
}

const NOTHING: Detailed = { detail: null, refusal: null };

/** Asks for the event; null wants none. */
export function useDetail(runs: Runs, run: string, sequence: number | null): Detailed {
  const [found, setFound] = useState(NOTHING);
  useEffect(() => {
    if (sequence === null) return;
    let isWanted = true;
    eventDetail(runs, run, sequence).then(
      (detail) => {
        if (isWanted) setFound({ detail, refusal: null });
      },
      (error: unknown) => {
        const refusal = error instanceof Error ? error.message : String(error);
        if (isWanted) setFound(({ detail }) => ({ detail, refusal }));
      },
    );
    return () => {
      isWanted = false;
    };
  }, [runs, run, sequence]);
  return found;
}
