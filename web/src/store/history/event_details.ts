/** Events of runs with their values, each requested once because events do not change. The cache holds the newest requests. */

import type { EventDetail } from "../../model/generated/protocol.ts";
import type { Runs } from "./run.ts";

const KEPT_MAX = 300;
const kept = new Map<string, Promise<EventDetail>>();

/** One event with all stored values. Rejects with a `RefusalError`; the next call then requests it again. */
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
