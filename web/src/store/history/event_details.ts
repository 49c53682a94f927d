/** Events of runs with their values, asked for once: what happened does not change. The newest of them are kept. */

import type { EventDetail } from "../../model/generated/protocol.ts";
import type { Runs } from "./run.ts";

const KEPT_MAX = 300;
const kept = new Map<string, Promise<EventDetail>>();

/** One event with all that is kept of its values. Fails with a `RefusalError`, and is asked for again by the next who wants it. */
export function eventDetail(runs: Runs, run: string, sequence: number): Promise<EventDetail> {
  const key = `${run} ${sequence}`;
  const known = kept.get(key);
  if (known) return known;
  const asked = runs.get<EventDetail>(run, `events/${sequence}`);
  kept.set(key, asked);
  asked.catch(() => kept.delete(key));
  for (const oldest of kept.keys()) {
    if (kept.size <= KEPT_MAX) break;
    kept.delete(oldest);
  }
  return asked;
}
