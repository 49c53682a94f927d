/** What a browser's trace says about frames: how long scripts ran for each, and how far apart they were shown. */

import type { CDPSession } from "playwright-core";

/** One event of a trace, as Chromium writes it; times in µs. */
export interface TraceEvent {
  readonly name: string;
  readonly ph: string;
  readonly ts: number;
  readonly dur?: number;
  readonly pid: number;
  readonly tid: number;
}

const CATEGORIES = ["devtools.timeline", "disabled-by-default-devtools.timeline.frame"];

/** Everything that the browser does while the work goes on. */
export async function traced(
  session: CDPSession,
  work: () => Promise<void>,
): Promise<readonly TraceEvent[]> {
  const events: TraceEvent[] = [];
  const collect = ({ value }: { value: readonly object[] }) => {
    events.push(...(value as readonly TraceEvent[]));
  };
  session.on("Tracing.dataCollected", collect);
  const complete = new Promise<void>((done) =>
    session.once("Tracing.tracingComplete", () => done()),
  );
  await session.send("Tracing.start", {
    transferMode: "ReportEvents",
    traceConfig: { includedCategories: [...CATEGORIES, "devtools.timeline.frame"] },
  });
  await work();
  await session.send("Tracing.end");
  await complete;
  session.off("Tracing.dataCollected", collect);
  return events.sort((one, other) => one.ts - other.ts);
}

/** What counts as scripting: callbacks, handlers, promises, collecting garbage. */
const SCRIPTING = new Set([
  "FireAnimationFrame",
  "EventDispatch",
  "FunctionCall",
  "TimerFire",
  "RunMicrotasks",
  "MinorGC",
  "MajorGC",
]);

/** Two callbacks that are closer than this, in µs, belong to one frame. */
const SAME_FRAME = 1_500;

/** The scripting time in ms of each frame that the page drew: its callback, and what ran since the frame before. */
export function scriptingPerFrame(events: readonly TraceEvent[]): readonly number[] {
  const callbacks = events.filter(({ name, ph }) => name === "FireAnimationFrame" && ph === "X");
  const thread = busiest(callbacks);
  if (!thread) return [];
  const own = events.filter(
    ({ name, ph, pid, tid }) =>
      ph === "X" && pid === thread.pid && tid === thread.tid && SCRIPTING.has(name),
  );
  const ends = frameEnds(
    callbacks.filter(({ pid, tid }) => pid === thread.pid && tid === thread.tid),
  );
  const times = ends.map(() => 0);
  let [frame, until] = [0, 0];
  for (const { ts, dur = 0 } of own) {
    while (frame < ends.length && ts >= (ends[frame] ?? 0)) frame++;
    if (frame >= ends.length) break;
    const begin = Math.max(ts, until);
    const end = ts + dur;
    if (end <= begin) continue;
    until = end;
    times[frame] = (times[frame] ?? 0) + (end - begin) / 1_000;
  }
  return times;
}

/** The thread that most of these ran on: that of the page. */
function busiest(events: readonly TraceEvent[]): TraceEvent | undefined {
  const counts = new Map<string, { count: number; event: TraceEvent }>();
  for (const event of events) {
    const key = `${event.pid} ${event.tid}`;
    const found = counts.get(key) ?? { count: 0, event };
    counts.set(key, { ...found, count: found.count + 1 });
  }
  return [...counts.values()].sort((one, other) => other.count - one.count)[0]?.event;
}

function frameEnds(callbacks: readonly TraceEvent[]): number[] {
  const ends: number[] = [];
  for (const { ts, dur = 0 } of callbacks) {
    const last = ends.at(-1);
    if (last !== undefined && ts - last < SAME_FRAME) ends[ends.length - 1] = ts + dur;
    else ends.push(ts + dur);
  }
  return ends;
}

/** The times in ms between frames that were shown one after the other. */
export function presentedIntervals(events: readonly TraceEvent[]): readonly number[] {
  const shown = events.filter(({ name }) => name === "DrawFrame");
  const thread = busiest(shown);
  const times = shown.filter(({ pid, tid }) => pid === thread?.pid && tid === thread.tid);
  return times.slice(1).map(({ ts }, at) => (ts - (times[at]?.ts ?? ts)) / 1_000);
}

export function median(values: readonly number[]): number {
  return quantile(values, 0.5);
}

/** The value that this part of them does not exceed. */
export function quantile(values: readonly number[], part: number): number {
  const sorted = [...values].sort((one, other) => one - other);
  return sorted[Math.min(sorted.length - 1, Math.floor(sorted.length * part))] ?? Number.NaN;
}
