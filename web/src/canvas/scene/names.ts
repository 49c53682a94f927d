/** Names of states: on a plate at the top of a container, in the middle of other states; with badges beside them. */

import type { Box, Point, Size } from "../../model/geometry.ts";
import type { SceneBuilder, SceneNode } from "./builder.ts";
import { DETAIL, fade, TEXT } from "./detail.ts";
import type { Icon, IconMark, Layer } from "./list.ts";
import { groundInk } from "./ring.ts";
import { FRAME } from "./sticky.ts";
import { cut, wrappedName } from "./words.ts";

const BADGE = 12;

/** `open` is a state with visible content. */
export function nameMarks(builder: SceneBuilder, node: SceneNode, open: boolean): void {
  const alpha = fade(node.extent, DETAIL.name);
  if (alpha === 0) return;
  const layer = builder.layer(node.depth);
  const badges = badgesOf(builder, node);
  if (open || node.extent >= DETAIL.labels) plateMarks(builder, node, layer, badges, alpha);
  else middleMarks(builder, node, layer, badges, alpha);
}

function badgesOf(
  builder: SceneBuilder,
  { at }: SceneNode,
): readonly Pick<IconMark, "icon" | "ink">[] {
  const found: Pick<IconMark, "icon" | "ink">[] = [];
  const kind = KIND_ICONS[at.state.kind];
  if (kind) found.push({ icon: kind, ink: "soft" });
  if (at.state.library?.missing != null) found.push({ icon: "missing", ink: "aborted" });
  const problem = builder.input.problems.get(at.path);
  if (problem === "error") found.push({ icon: "error", ink: "aborted" });
  if (problem === "warning") found.push({ icon: "warning", ink: "waiting" });
  const difference = builder.input.differences.get(at.key);
  if (difference) found.push({ icon: difference, ink: difference });
  return found;
}

const KIND_ICONS: Readonly<Record<string, Icon>> = {
  library: "library",
  barrier: "barrier",
  preemptive: "preemptive",
  decider: "decider",
};

/** Name of a container on a plate: at its own position, inside the view, and without overlap with the names around it. Without
 * enough room it is left out, until the user zooms in. */
function plateMarks(
  builder: SceneBuilder,
  node: SceneNode,
  layer: Layer,
  badges: readonly Pick<IconMark, "icon" | "ink">[],
  alpha: number,
): void {
  const { measure } = builder.input;
  const size = node.extent >= 420 ? TEXT.large : TEXT.usual;
  const side = badges.length * (BADGE + 3);
  const room = Math.min(node.width - 10, 420) - side - 8;
  const text = cut(node.at.state.name, room, size, true, measure);
  if (text === "" && badges.length === 0) return;
  const width = (text === "" ? 0 : measure(text, size, true)) + side + 10;
  const height = size + 7;
  const at = free(builder, node, { width, height });
  if (!at) return;
  builder.plates.push({ ...at, width, height });
  const middle = at.y + height / 2;
  putBadges(layer, node, badges, at.x + 4, middle, alpha);
  layer.texts.push({
    what: `${node.at.key} name`,
    x: at.x + 5 + side,
    y: middle,
    text,
    size,
    bold: true,
    ink: "text",
    align: "left",
    alpha,
    plate: groundInk(node),
    width: width - side - 10,
    lead: side,
  });
}

/** Space for the signs of a run in the upper right corner. */
const SIGNS = 34;

function free(builder: SceneBuilder, node: SceneNode, { width, height }: Size): Point | null {
  const name = node.at.name;
  const signs = builder.input.runs.has(node.at.path) ? SIGNS : 0;
  const right = Math.min(node.x + node.width, builder.width) - width - 4 - signs;
  const bottom = Math.min(node.y + node.height, builder.height) - height - 2;
  const edge = builder.isCoveredBy(node) ? FRAME + 6 : 4;
  const x = Math.min(Math.max(node.x + Math.min(name.x * node.scale, 10), edge), right);
  const left = Math.max(x, node.x + 2);
  const top = Math.max(node.y + Math.min(name.y * node.scale, 6), edge);
  const fits = (at: Point) =>
    at.y <= bottom &&
    at.x <= right + 1 &&
    !builder.plates.some((plate) => meets(plate, at.x, at.y, width, height));
  const own = { x: left, y: top };
  if (fits(own)) return own;
  // Other places must cover no child: the name would appear to belong to the child.
  const isPlace = (at: Point) => fits(at) && isOnGround(node, at, { width, height });
  return (
    elsewhere(builder, own, { x: left, y: bottom - 2 }, { width, height }).find(isPlace) ?? null
  );
}

/** Alternative places for a name: beside the plates at its own place, below them, and in the lower left. */
function elsewhere(
  { plates }: SceneBuilder,
  own: Point,
  lowerLeft: Point,
  { width, height }: Size,
): readonly Point[] {
  const met = plates.filter((plate) =>
    meets(plate, own.x, own.y, Number.POSITIVE_INFINITY, height),
  );
  const below = plates.filter((plate) =>
    meets(plate, own.x, own.y, width, Number.POSITIVE_INFINITY),
  );
  return [
    ...met.map((plate) => ({ x: plate.x + plate.width + 6, y: own.y })),
    ...below.map((plate) => ({ x: own.x, y: plate.y + plate.height + 2 })),
    lowerLeft,
  ];
}

/** True if a plate covers no state inside. */
function isOnGround(node: SceneNode, { x, y }: Point, { width, height }: Size): boolean {
  let isFree = true;
  const area = {
    x: (x - node.x) / node.scale,
    y: (y - node.y) / node.scale,
    width: width / node.scale,
    height: height / node.scale,
  };
  node.at.eachChild(area, () => {
    isFree = false;
  });
  return isFree;
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
  builder: SceneBuilder,
  node: SceneNode,
  layer: Layer,
  badges: readonly Pick<IconMark, "icon" | "ink">[],
  alpha: number,
): void {
  const { measure } = builder.input;
  const size = node.extent >= 84 ? TEXT.usual : TEXT.small;
  const pitch = size * 1.25;
  const room = node.width - (node.extent >= DETAIL.ports ? 18 : 8);
  const top = freeFrom(builder, node);
  const height = node.y + node.height - top;
  const rows = Math.min(3, Math.floor(height / pitch));
  const lines = rows > 0 ? wrappedName(node.at.state.name, room, rows, size, measure) : [];
  const middle = top + height / 2;
  let y = middle - ((lines.length - 1) * pitch) / 2;
  for (const text of lines) {
    layer.texts.push({
      what: `${node.at.key} name`,
      x: node.x + node.width / 2,
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
    node,
    badges,
    node.x + (lines.length === 0 ? (node.width - width) / 2 : 5),
    row,
    alpha,
  );
}

/** Top of the free area below the names of outer states that reach into this one. */
function freeFrom({ plates }: SceneBuilder, { x, y, width, height }: SceneNode): number {
  let top = y;
  for (const plate of plates) {
    if (meets(plate, x, y, width, height)) top = Math.max(top, plate.y + plate.height);
  }
  return top;
}

function putBadges(
  layer: Layer,
  node: SceneNode,
  badges: readonly Pick<IconMark, "icon" | "ink">[],
  x: number,
  y: number,
  alpha: number,
): void {
  badges.forEach((badge, index) => {
    const at = x + BADGE / 2 + index * (BADGE + 3);
    layer.icons.push({
      ...badge,
      what: `${node.at.key} ${badge.icon}`,
      x: at,
      y,
      size: BADGE,
      alpha,
    });
  });
}
