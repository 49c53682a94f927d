/** Lines of the tree of steps, for one row of the list. */

import type { StepRow } from "../../model/steps.ts";

const LANE_PX = 12;
const HEIGHT_PX = 24;
const LANES_MAX = 8;

function x(lane: number): number {
  return 8 + Math.min(lane, LANES_MAX) * LANE_PX;
}

/** Width of the lines of all rows, in CSS pixels. */
export function graphWidth(rows: readonly StepRow[]): number {
  const widest = rows.reduce((most, { lane, above }) => Math.max(most, lane, ...above), 0);
  return x(widest) + 10;
}

export function Graph({ row }: { readonly row: StepRow }) {
  const middle = HEIGHT_PX / 2;
  const { lane, above, below, joins, place } = row;
  const through = above.filter((each) => !joins.includes(each));
  return (
    <svg className="edits-graph" width={x(LANES_MAX) + 10} height={HEIGHT_PX} aria-hidden="true">
      {through.map((each) => (
        <line key={`a${each}`} x1={x(each)} x2={x(each)} y1={0} y2={middle} />
      ))}
      {below.map((each) => (
        <line key={`b${each}`} x1={x(each)} x2={x(each)} y1={middle} y2={HEIGHT_PX} />
      ))}
      {joins.map((each) => (
        <path
          key={`j${each}`}
          d={`M${x(each)} 0 C${x(each)} ${middle} ${x(lane)} 2 ${x(lane)} ${middle}`}
        />
      ))}
      <circle className={`edits-dot-${place}`} cx={x(lane)} cy={middle} r={4} />
    </svg>
  );
}
