/** Positions of lanes and their rows on the timeline. A folded lane has a single row with its innermost states. */

import type { Calls } from "../../store/history/calls.ts";
import { CallRow, type Lane } from "../../store/history/lanes.ts";
import type { SeenLane, SeenRow } from "../../store/history/seen.ts";
import type { TimeSpan } from "./span.ts";

export const ROW_PX = 18;
const GAP_PX = 6;

interface LaneRow {
  readonly row: CallRow | SeenRow;
  readonly y: number;
}

interface LaneBox {
  readonly lane: Lane | SeenLane;
  readonly y: number;
  readonly height: number;
  readonly isFolded: boolean;
  readonly rows: readonly LaneRow[];
}

export interface TimelineLayout {
  readonly lanes: readonly LaneBox[];
  readonly height: number;
}

/** Lanes from top to bottom. Inner lanes of a folded lane stay. */
export function layoutOf(
  lanes: readonly (Lane | SeenLane)[],
  folded: ReadonlySet<string>,
): TimelineLayout {
  let y = GAP_PX / 2;
  const boxes = lanes.map((lane) => {
    const isFolded = folded.has(lane.path);
    const shown = isFolded ? [lane.leaves] : lane.rows;
    const rows = shown.map((row, index) => ({ row, y: y + index * ROW_PX }));
    const box = { lane, y, height: shown.length * ROW_PX, isFolded, rows };
    y += box.height + GAP_PX;
    return box;
  });
  return { lanes: boxes, height: y };
}

/** Lanes with activity in a part of the run's time. The lanes around an active one are active, too. */
export function lanesIn<L extends Lane | SeenLane>(
  calls: Calls,
  lanes: readonly L[],
  span: TimeSpan,
): readonly L[] {
  const from = calls.journal.indexAt(span.from_ns);
  const until = calls.journal.indexAt(span.to_ns + 1);
  return lanes.filter(({ rows: [row] }) =>
    row instanceof CallRow
      ? row.firstOpenAfter(from - 1) < row.firstFrom(until)
      : (row?.between(span.from_ns, span.to_ns).length ?? 0) > 0,
  );
}

/** Row at a height; undefined between lanes. */
export function rowAt(layout: TimelineLayout, y: number): LaneRow | undefined {
  const box = layout.lanes.find((lane) => y >= lane.y && y < lane.y + lane.height);
  return box?.rows[Math.floor((y - box.y) / ROW_PX)];
}
