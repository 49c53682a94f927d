/** What of a row shows in a part of a run's time: a bar for each call that is wide enough; of those that are not, how many lie
 * together and how many of them failed. So a row costs as much as it is wide, however much happened. */

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
      /** How many calls. */
      readonly many: number;
      readonly failed: number;
      /** The first of them. */
      readonly first: number;
    };

/** Below this width in CSS pixels calls are drawn together. */
export const NARROW_PX = 2;

export interface Scale {
  readonly span: TimeSpan;
  readonly width: number;
  /** Until when what goes on has come. */
  readonly end_ns: number;
}

export function xOf({ span, width }: Scale, t_ns: number): number {
  return ((t_ns - span.from_ns) / (span.to_ns - span.from_ns)) * width;
}

export function timeAt({ span, width }: Scale, x: number): number {
  return span.from_ns + (x / width) * (span.to_ns - span.from_ns);
}

/** From left to right. */
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

/** What left an error looks as what aborted, whatever its outcome. */
function barLook(calls: Calls, call: number): CallLook {
  return hasFailed(calls, call) ? "aborted" : lookOf(calls, call);
}

/** The place in the row behind the narrow calls that begin in the same pixels; a wide one at their end stands for itself. */
function together(calls: Calls, row: CallRow, scale: Scale, x: number): number {
  const edge = Math.floor(x) + NARROW_PX;
  const behind = row.firstFrom(calls.journal.indexAt(timeAt(scale, edge)));
  const last = row.calls[behind - 1] ?? NONE;
  const isWide =
    last !== NONE &&
    xOf(scale, calls.ended_ns(last, scale.end_ns)) - xOf(scale, calls.began_ns(last)) >= NARROW_PX;
  return isWide ? behind - 1 : behind;
}

/** The call of a row at a time; NONE if nothing ran there. */
export function callAt(calls: Calls, row: CallRow, t_ns: number, end_ns: number): number {
  const { journal } = calls;
  const place = row.firstFrom(journal.indexAt(t_ns + 1)) - 1;
  const call = row.calls[place] ?? NONE;
  return call !== NONE && calls.ended_ns(call, end_ns) >= t_ns ? call : NONE;
}
