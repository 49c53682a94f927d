/** Visible bars of a row: one for each call that is wide enough. Narrow calls are merged into one bar with their number and the
 * number of failures. The cost of a row depends on its width, not on its number of calls. */

import { type Calls, NONE } from "../../store/history/calls.ts";
import { type CallLook, type CallRow, hasFailed, lookOf } from "../../store/history/lanes.ts";
import { type SeenBar, SeenRow } from "../../store/history/seen.ts";
import type { TimeSpan } from "./span.ts";

export type Bar =
  | { readonly x: number; readonly width: number; readonly seen: SeenBar }
  | { readonly x: number; readonly width: number; readonly call: number; readonly look: CallLook }
  | {
      readonly x: number;
      readonly width: number;
      /** Number of merged calls. */
      readonly many: number;
      readonly failed: number;
      /** First merged call. */
      readonly first: number;
    };

/** Width below which calls are merged, in CSS pixels. */
export const NARROW_PX = 2;

export interface Scale {
  readonly span: TimeSpan;
  readonly width: number;
  /** End of active calls, in ns. */
  readonly end_ns: number;
}

export function xOf({ span, width }: Scale, t_ns: number): number {
  return ((t_ns - span.from_ns) / (span.to_ns - span.from_ns)) * width;
}

export function timeAt({ span, width }: Scale, x: number): number {
  return span.from_ns + (x / width) * (span.to_ns - span.from_ns);
}

/** Bars from left to right. */
export function barsOf(calls: Calls, row: CallRow | SeenRow, scale: Scale): readonly Bar[] {
  return row instanceof SeenRow ? seenBars(row, scale) : hereBars(calls, row, scale);
}

function seenBars(row: SeenRow, scale: Scale): readonly Bar[] {
  return row.between(scale.span.from_ns, scale.span.to_ns).map((seen) => {
    const x = xOf(scale, seen.from_ns);
    const width = xOf(scale, seen.to_ns ?? Math.max(scale.end_ns, seen.from_ns)) - x;
    return { x, width: Math.max(NARROW_PX, width), seen };
  });
}

function hereBars(calls: Calls, row: CallRow, scale: Scale): readonly Bar[] {
  const { journal } = calls;
  const bars: Bar[] = [];
  const first = journal.indexAt(scale.span.from_ns);
  const until = row.firstFrom(journal.indexAt(scale.span.to_ns + 1));
  let at = row.firstOpenAfter(first - 1);
  while (at < until) {
    const call = row.calls[at] ?? NONE;
    const x = xOf(scale, calls.began_ns(call));
    const end = xOf(scale, calls.ended_ns(call, scale.end_ns));
    if (end - x >= NARROW_PX) {
      bars.push({ x, width: end - x, call, look: barLook(calls, call) });
      at += 1;
      continue;
    }
    const next = Math.max(at + 1, Math.min(until, together(calls, row, scale, x)));
    bars.push({
      x: Math.floor(x),
      width: NARROW_PX,
      many: next - at,
      failed: row.failed(at, next),
      first: call,
    });
    at = next;
  }
  return bars;
}

/** Style of a bar. A call with an error has the style of an aborted one, whatever its outcome. */
function barLook(calls: Calls, call: number): CallLook {
  return hasFailed(calls, call) ? "aborted" : lookOf(calls, call);
}

/** Index in the row after the narrow calls that begin in the pixels at `x`. A wide call at their end is left out. */
function together(calls: Calls, row: CallRow, scale: Scale, x: number): number {
  const edge = Math.floor(x) + NARROW_PX;
  const behind = row.firstFrom(calls.journal.indexAt(timeAt(scale, edge)));
  const last = row.calls[behind - 1] ?? NONE;
  const isWide =
    last !== NONE &&
    xOf(scale, calls.ended_ns(last, scale.end_ns)) - xOf(scale, calls.began_ns(last)) >= NARROW_PX;
  return isWide ? behind - 1 : behind;
}

/** Call of a row at a time; NONE if there is none. */
export function callAt(calls: Calls, row: CallRow, t_ns: number, end_ns: number): number {
  const { journal } = calls;
  const place = row.firstFrom(journal.indexAt(t_ns + 1)) - 1;
  const call = row.calls[place] ?? NONE;
  return call !== NONE && calls.ended_ns(call, end_ns) >= t_ns ? call : NONE;
}
