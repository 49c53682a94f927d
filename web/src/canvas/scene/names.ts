/** Names of states: of a container on a plate at its top, of others in their middle; and the badges beside them. */

import type { Box } from "../../model/geometry.ts";
import { DETAIL, fade, TEXT } from "./detail.ts";
import type { Drawing, Spot } from "./drawing.ts";
import type { Icon, IconMark, Layer } from "./list.ts";
import { groundInk } from "./ring.ts";
import { FRAME } from "./sticky.ts";
import { cut, wrapped } from "./words.ts";

const BADGE = 12;

/** `open` is a state whose content shows. */
export function nameMarks(drawing: Drawing, spot: Spot, open: boolean): void {
  const alpha = fade(spot.extent, DETAIL.name);
  if (alpha === 0) return;
  const layer = drawing.layer(spot.depth);
  const badges = badgesOf(drawing, spot);
  if (open || spot.extent >= DETAIL.labels) plateMarks(drawing, spot, layer, badges, alpha);
  else middleMarks(drawing, spot, layer, badges, alpha);
}

function badgesOf(drawing: Drawing, { at }: Spot): readonly Pick<IconMark, "icon" | "ink">[] {
  const found: Pick<IconMark, "icon" | "ink">[] = [];
  const kind = KIND_ICONS[at.state.kind];
  if (kind) found.push({ icon: kind, ink: "soft" });
  if (at.state.library?.missing != null) found.push({ icon: "missing", ink: "aborted" });
  const problem = drawing.input.problems.get(at.path);
  if (problem === "error") found.push({ icon: "error", ink: "aborted" });
  if (problem === "warning") found.push({ icon: "warning", ink: "waiting" });
  const difference = drawing.input.differences.get(at.key);
  if (difference) found.push({ icon: difference, ink: difference });
  return found;
}

const KIND_ICONS: Readonly<Record<string, Icon>> = {
  library: "library",
  barrier: "barrier",
  preemptive: "preemptive",
  decider: "decider",
};

/** Where a container's name stands: at its own place, inside the view, and clear of the names around it. Where there is little room
 * it gives way to them: it comes when one looks closer. */
function plateMarks(
  drawing: Drawing,
  spot: Spot,
  layer: Layer,
  badges: readonly Pick<IconMark, "icon" | "ink">[],
  alpha: number,
): void {
  const { measure, modes } = drawing.input;
  const size = spot.extent >= 420 ? TEXT.large : TEXT.usual;
  const side = badges.length * (BADGE + 3);
  const room = Math.min(spot.width - 10, 420) - side - 8;
  const text = modes.names ? cut(spot.at.state.name, room, size, true, measure) : "";
  if (text === "" && badges.length === 0) return;
  const width = (text === "" ? 0 : measure(text, size, true)) + side + 10;
  const height = size + 7;
  const at = free(drawing, spot, { width, height });
  if (!at) return;
  drawing.plates.push({ ...at, width, height });
  const middle = at.y + height / 2;
  putBadges(layer, spot, badges, at.x + 4, middle, alpha);
  layer.texts.push({
    what: `${spot.at.key} name`,
    x: at.x + 5 + side,
    y: middle,
    text,
    size,
    bold: true,
    ink: "text",
    align: "left",
    alpha,
    plate: groundInk(spot),
    width: width - side - 10,
    lead: side,
  });
}

/** Room for what a run shows in the upper right corner. */
const SIGNS = 34;

function free(
  drawing: Drawing,
  spot: Spot,
  { width, height }: { readonly width: number; readonly height: number },
): { readonly x: number; readonly y: number } | null {
  const name = spot.at.name;
  const signs = drawing.input.runs.has(spot.at.path) ? SIGNS : 0;
  const right = Math.min(spot.x + spot.width, drawing.width) - width - 4 - signs;
  const bottom = Math.min(spot.y + spot.height, drawing.height) - height - 2;
  const edge = drawing.isCoveredBy(spot) ? FRAME + 6 : 4;
  const x = Math.min(Math.max(spot.x + Math.min(name.x * spot.scale, 10), edge), right);
  let y = Math.max(spot.y + Math.min(name.y * spot.scale, 6), edge);
  let left = Math.max(x, spot.x + 2);
  for (const plate of drawing.plates) {
    if (!meets(plate, left, y, width, height)) continue;
    if (plate.x + plate.width + 6 <= right) left = plate.x + plate.width + 6;
    else if (spot.extent < DETAIL.labels) return null;
    else y = plate.y + plate.height + 2;
  }
  return y > bottom || left > right + 1 ? null : { x: left, y };
}

function meets(plate: Box, x: number, y: number, width: number, height: number): boolean {
  return (
    x < plate.x + plate.width &&
    plate.x < x + width &&
    y < plate.y + plate.height &&
    plate.y < y + height
  );
}

function middleMarks(
  drawing: Drawing,
  spot: Spot,
  layer: Layer,
  badges: readonly Pick<IconMark, "icon" | "ink">[],
  alpha: number,
): void {
  const { measure, modes } = drawing.input;
  const size = spot.extent >= 84 ? TEXT.usual : TEXT.small;
  const pitch = size * 1.25;
  const room = spot.width - (spot.extent >= DETAIL.ports ? 18 : 8);
  const top = freeFrom(drawing, spot);
  const height = spot.y + spot.height - top;
  const rows = Math.min(3, Math.floor(height / pitch));
  const lines =
    modes.names && rows > 0 ? wrapped(spot.at.state.name, room, rows, size, measure) : [];
  const middle = top + height / 2;
  let y = middle - ((lines.length - 1) * pitch) / 2;
  for (const text of lines) {
    layer.texts.push({
      what: `${spot.at.key} name`,
      x: spot.x + spot.width / 2,
      y,
      text,
      size,
      bold: false,
      ink: "text",
      align: "center",
      alpha,
      plate: null,
      width: measure(text, size, false),
    });
    y += pitch;
  }
  const isRoomy = height > lines.length * pitch + 2 * BADGE;
  if (badges.length === 0 || (!isRoomy && lines.length > 0)) return;
  const width = badges.length * (BADGE + 3) - 3;
  const row = lines.length === 0 ? middle : top + 4 + BADGE / 2;
  putBadges(
    layer,
    spot,
    badges,
    spot.x + (lines.length === 0 ? (spot.width - width) / 2 : 5),
    row,
    alpha,
  );
}

/** Below the names of states around that reach into this one. */
function freeFrom({ plates }: Drawing, { x, y, width, height }: Spot): number {
  let top = y;
  for (const plate of plates) {
    if (meets(plate, x, y, width, height)) top = Math.max(top, plate.y + plate.height);
  }
  return top;
}

function putBadges(
  layer: Layer,
  spot: Spot,
  badges: readonly Pick<IconMark, "icon" | "ink">[],
  x: number,
  y: number,
  alpha: number,
): void {
  badges.forEach((badge, index) => {
    const at = x + BADGE / 2 + index * (BADGE + 3);
    layer.icons.push({
      ...badge,
      what: `${spot.at.key} ${badge.icon}`,
      x: at,
      y,
      size: BADGE,
      alpha,
    });
  });
}
