/** Guide lines for the alignment of boxes that are moved or resized. All values are in the root's coordinates. */

import { type Box, intersects, type Point } from "../../model/geometry.ts";
import { visibleBox } from "../camera/camera.ts";
import { childrenIn } from "../hit/near.ts";
import type { Overlay } from "../overlay.ts";
import { stepFor } from "../scene/gridlines.ts";
import type { ToolContext } from "./gesture.ts";

export type Guides = Overlay["guides"];

/** Distance at which a box snaps, in CSS pixels. */
const SNAP = 5;

/** Boxes that a box can align with: the visible children of a container, except those in `without`, and the container itself. */
export function neighbours(
  context: ToolContext,
  container: string,
  without: ReadonlySet<string>,
): readonly Box[] {
  const { layout, camera, size } = context;
  const seen = visibleBox(camera, size);
  const paths = childrenIn(layout, container, seen).filter((path) => !without.has(path));
  return [...paths, container].flatMap((path) => {
    const box = layout.box(path);
    return box && intersects(box, seen) ? [box] : [];
  });
}

type Axis = "x" | "y";

interface Fit {
  /** Distance to the aligned position. */
  readonly by: number;
  readonly at: number;
  readonly box: Box;
}

/** Lines of the box that align: its start, middle and end along each axis. */
export type Lines = readonly (0 | 0.5 | 1)[];

/** Distance to the nearest alignment with other boxes, or else with a visible grid, and the guide lines that show it. */
export function snapped(
  box: Box,
  others: readonly Box[],
  context: ToolContext,
  lines: { readonly x: Lines; readonly y: Lines } = { x: [0, 0.5, 1], y: [0, 0.5, 1] },
): { readonly by: Point; readonly guides: Guides } {
  const reach = SNAP / context.camera.scale;
  const x = best(box, others, "x", lines.x, reach);
  const y = best(box, others, "y", lines.y, reach);
  const by = {
    x: x?.by ?? toRuled(box, "x", lines.x, context),
    y: y?.by ?? toRuled(box, "y", lines.y, context),
  };
  const there = { ...box, x: box.x + by.x, y: box.y + by.y };
  const guides: Guides[number][] = [];
  if (x) guides.push(guide(there, x, "x"));
  if (y) guides.push(guide(there, y, "y"));
  return { by, guides };
}

/** Distance from the first line of a box to the nearest line of the grid; 0 while the grid is hidden. */
function toRuled(box: Box, axis: Axis, [line]: Lines, { look, camera }: ToolContext): number {
  if (!look.modes.grid || line === undefined) return 0;
  const step = stepFor(camera.scale);
  const at = box[axis] + box[axis === "x" ? "width" : "height"] * line;
  return Math.round(at / step) * step - at;
}

function best(
  box: Box,
  others: readonly Box[],
  axis: Axis,
  lines: Lines,
  reach: number,
): Fit | null {
  const length = axis === "x" ? "width" : "height";
  let found: Fit | null = null;
  for (const other of others) {
    for (const part of lines) {
      const own = box[axis] + box[length] * part;
      for (const otherPart of part === 0.5 ? [0.5] : [0, 1]) {
        const at = other[axis] + other[length] * otherPart;
        const by = at - own;
        if (Math.abs(by) > reach || (found && Math.abs(by) >= Math.abs(found.by))) continue;
        found = { by, at, box: other };
      }
    }
  }
  return found;
}

/** Guide line through both boxes. */
function guide(box: Box, { at, box: other }: Fit, axis: Axis): Guides[number] {
  const [along, length] = axis === "x" ? (["y", "height"] as const) : (["x", "width"] as const);
  const from = Math.min(box[along], other[along]);
  const to = Math.max(box[along] + box[length], other[along] + other[length]);
  return axis === "x"
    ? { from: { x: at, y: from }, to: { x: at, y: to } }
    : { from: { x: from, y: at }, to: { x: to, y: at } };
}
