/** What can be seen of a machine, in which detail: pure, from the camera to a list of marks. */

import type { PlacedState } from "../tree.ts";
import { connectionMarks } from "./connections.ts";
import { DETAIL, extent, SPECK } from "./detail.ts";
import { Drawing, type Spot, shade } from "./drawing.ts";
import { gestureMarks } from "./gesture.ts";
import type { SceneInput } from "./input.ts";
import { labelMarks } from "./labels.ts";
import type { BoxMark, DrawList } from "./list.ts";
import { nameMarks } from "./names.ts";
import { pointedMarks } from "./pointed.ts";
import { portMarks } from "./ports.ts";
import { ruledMarks } from "./ruled.ts";
import { closedPhase, RUN_INKS } from "./runs.ts";
import { stateMarks } from "./states.ts";
import { stickyMarks } from "./sticky.ts";

/** Deeper than machines usually are. */
const LIFT = 16;
/** So far beyond the view something may still reach into it. */
const REACH = 12;

export function scene(input: SceneInput): DrawList {
  const drawing = new Drawing(input);
  const { root } = input.placed;
  if (root) {
    visit(drawing, rootSpot(root, input), NOTHING);
    ruledMarks(drawing);
    stickyMarks(drawing);
    labelMarks(drawing);
    pointedMarks(drawing);
    gestureMarks(drawing);
  }
  const { layers, wanted, soon, unfinished } = drawing;
  return { layers, wanted, soon, unfinished };
}

const NOTHING: ReadonlySet<string> = new Set();

function rootSpot(root: PlacedState, { camera }: SceneInput): Spot {
  return spotOf(root, -camera.x * camera.scale, -camera.y * camera.scale, camera.scale, 0, null);
}

function spotOf(
  at: PlacedState,
  x: number,
  y: number,
  scale: number,
  depth: number,
  outer: Spot | null,
): Spot {
  const [width, height] = [at.size.width * scale, at.size.height * scale];
  return { at, x, y, width, height, scale, depth, extent: extent({ width, height }), outer };
}

/** Draws a state that is in sight and large enough, and what is inside it. */
function visit(drawing: Drawing, spot: Spot, connected: ReadonlySet<string>): void {
  const children = childrenOf(drawing, spot);
  const open = children.length > 0 && spot.extent >= DETAIL.content;
  stateMarks(drawing, spot, open);
  const isAround = drawing.isCoveredBy(spot);
  if (!isAround || !open) nameMarks(drawing, spot, open);
  if (open) {
    connectionMarks(drawing, spot);
    const { joined } = spot.at;
    spot.at.eachChild(drawing.area(spot, REACH), (child) =>
      visitChild(drawing, spot, child, joined),
    );
  } else {
    if (children.length > 0 && !spot.at.hasLines) drawing.soon.push(spot.at);
    for (const child of children) textureOf(drawing, spot, child);
  }
  if (isAround) drawing.covering ??= spot;
  else portMarks(drawing, spot, connected, open);
}

const NO_CHILDREN: readonly PlacedState[] = [];

/** The children, if the state is large enough to show anything of them. */
function childrenOf(drawing: Drawing, spot: Spot): readonly PlacedState[] {
  if (spot.extent < DETAIL.name) return NO_CHILDREN;
  const { children, opened, path } = spot.at;
  if (opened && children.length === 0) drawing.wanted.push(path);
  return children;
}

function visitChild(
  drawing: Drawing,
  outer: Spot,
  child: PlacedState,
  joined: ReadonlySet<string>,
): void {
  const { box } = child;
  const x = outer.x + box.x * outer.scale;
  const y = outer.y + box.y * outer.scale;
  const [width, height] = [box.width * outer.scale, box.height * outer.scale];
  const size = extent({ width, height });
  if (size < DETAIL.box) {
    if (size >= SPECK)
      drawing.layer(outer.depth + 1).specks.push(speck(drawing, outer, child, x, y, width, height));
    return;
  }
  const spot = spotOf(child, x, y, outer.scale * child.scale, outer.depth + 1, outer);
  const lift = drawing.input.overlay.boxes.has(child.path) ? LIFT : 0;
  drawing.lift += lift;
  visit(drawing, spot, joined);
  drawing.lift -= lift;
}

/** What a state has inside that is too small for its content: a hint of where something is. */
function textureOf(drawing: Drawing, outer: Spot, child: PlacedState): void {
  const { box } = child;
  const [width, height] = [box.width * outer.scale, box.height * outer.scale];
  if (width < SPECK || height < SPECK) return;
  const [x, y] = [outer.x + box.x * outer.scale, outer.y + box.y * outer.scale];
  const mark = speck(drawing, outer, child, x, y, width, height);
  drawing
    .layer(outer.depth + 1)
    .specks.push(drawing.input.runs.has(child.path) ? { ...mark, alpha: HINT } : mark);
}

/** Where something runs is told behind the name of the state that it lies in. */
const HINT = 0.45;

/** A state that is no more than a colour: that of how it runs, or of its depth. */
function speck(
  drawing: Drawing,
  outer: Spot,
  child: PlacedState,
  x: number,
  y: number,
  width: number,
  height: number,
): BoxMark {
  const { runs, hits, differences, heat } = drawing.input;
  const mark = runs.get(child.path);
  const run = mark && closedPhase(mark);
  const loud = drawing.isSelected(child.key)
    ? "selection"
    : (differences.get(child.key) ?? (hits.has(child.key) ? "hit" : undefined));
  const hot = heat?.get(child.path);
  const still = hot === undefined ? shade(outer.depth + 1) : `heat${hot}`;
  const quiet = run === undefined || run === "inside" ? still : RUN_INKS[run];
  return {
    what: child.key,
    x,
    y,
    width,
    height,
    radius: 0,
    fill: loud ?? quiet,
    stroke: null,
    line: 0,
    dash: false,
    alpha: 1,
  };
}
