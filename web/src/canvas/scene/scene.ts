/** Visible part of a machine and its level of detail: a pure function from the camera to a list of marks. */

import type { LayoutNode } from "../layout/layout_node.ts";
import { SceneBuilder, type SceneNode, shade } from "./builder.ts";
import { connectionMarks } from "./connections.ts";
import { DETAIL, extent, SPECK } from "./detail.ts";
import { gestureMarks } from "./gesture.ts";
import { ruledMarks } from "./gridlines.ts";
import type { SceneInput } from "./input.ts";
import { labelMarks } from "./labels.ts";
import type { BoxMark, DrawList } from "./list.ts";
import { nameMarks } from "./names.ts";
import { pointedMarks } from "./pointed.ts";
import { portMarks } from "./ports.ts";
import { closedPhase, RUN_INKS } from "./runs.ts";
import { stateMarks } from "./states.ts";
import { stickyMarks } from "./sticky.ts";

/** Number of layers for states of a gesture. It exceeds the usual depth of machines. */
const LIFT = 16;
/** Margin around the view from which marks may reach into it, in CSS pixels. */
const REACH = 12;

export function scene(input: SceneInput): DrawList {
  const builder = new SceneBuilder(input);
  const { root } = input.layout;
  if (root) {
    visit(builder, rootSpot(root, input), NOTHING);
    ruledMarks(builder);
    stickyMarks(builder);
    labelMarks(builder);
    pointedMarks(builder);
    gestureMarks(builder);
  }
  const { layers, wanted, soon, unfinished } = builder;
  return { layers, wanted, soon, unfinished };
}

const NOTHING: ReadonlySet<string> = new Set();

function rootSpot(root: LayoutNode, { camera }: SceneInput): SceneNode {
  return spotOf(root, -camera.x * camera.scale, -camera.y * camera.scale, camera.scale, 0, null);
}

function spotOf(
  at: LayoutNode,
  x: number,
  y: number,
  scale: number,
  depth: number,
  outer: SceneNode | null,
): SceneNode {
  const [width, height] = [at.size.width * scale, at.size.height * scale];
  return { at, x, y, width, height, scale, depth, extent: extent({ width, height }), outer };
}

/** Draws a visible and large enough state, and its content. */
function visit(builder: SceneBuilder, node: SceneNode, connected: ReadonlySet<string>): void {
  const children = childrenOf(builder, node);
  const open = children.length > 0 && node.extent >= DETAIL.content;
  stateMarks(builder, node, open);
  const isAround = builder.isCoveredBy(node);
  if (!isAround || !open) nameMarks(builder, node, open);
  if (open) {
    connectionMarks(builder, node);
    const { joined } = node.at;
    node.at.eachChild(builder.area(node, REACH), (child) =>
      visitChild(builder, node, child, joined),
    );
  } else {
    if (children.length > 0 && !node.at.hasLines) builder.soon.push(node.at);
    for (const child of children) textureOf(builder, node, child);
  }
  if (isAround) builder.covering ??= node;
  else portMarks(builder, node, connected, open);
}

const NO_CHILDREN: readonly LayoutNode[] = [];

/** Children, if the state is large enough to show any of them. */
function childrenOf(builder: SceneBuilder, node: SceneNode): readonly LayoutNode[] {
  if (node.extent < DETAIL.name) return NO_CHILDREN;
  const { children, opened, path } = node.at;
  if (opened && children.length === 0) builder.wanted.push(path);
  return children;
}

function visitChild(
  builder: SceneBuilder,
  outer: SceneNode,
  child: LayoutNode,
  joined: ReadonlySet<string>,
): void {
  const { box } = child;
  const x = outer.x + box.x * outer.scale;
  const y = outer.y + box.y * outer.scale;
  const [width, height] = [box.width * outer.scale, box.height * outer.scale];
  const size = extent({ width, height });
  if (size < DETAIL.box) {
    if (size >= SPECK)
      builder.layer(outer.depth + 1).specks.push(speck(builder, outer, child, x, y, width, height));
    return;
  }
  const node = spotOf(child, x, y, outer.scale * child.scale, outer.depth + 1, outer);
  const lift = builder.input.overlay.provisional?.held.has(child.path) ? LIFT : 0;
  builder.lift += lift;
  visit(builder, node, joined);
  builder.lift -= lift;
}

/** Speck for a child of a state that is too small to show its content. */
function textureOf(builder: SceneBuilder, outer: SceneNode, child: LayoutNode): void {
  const { box } = child;
  const [width, height] = [box.width * outer.scale, box.height * outer.scale];
  if (width < SPECK || height < SPECK) return;
  const [x, y] = [outer.x + box.x * outer.scale, outer.y + box.y * outer.scale];
  const mark = speck(builder, outer, child, x, y, width, height);
  const layer = builder.layer(outer.depth + 1);
  if (!builder.isSelected(child.key)) {
    layer.specks.push(builder.input.runs.has(child.path) ? { ...mark, alpha: HINT } : mark);
    return;
  }
  layer.specks.push({ ...mark, alpha: FAINT });
  layer.boxes.push({ ...mark, fill: null, stroke: "selection", line: 1.5 });
}

/** Opacity of a selected speck, low enough to keep the name of the outer state readable. */
const FAINT = 0.25;

/** Opacity of an active speck. The name of the outer state stays readable on it. */
const HINT = 0.45;

/** State as a coloured rectangle: the colour of its phase, or of its depth. */
function speck(
  builder: SceneBuilder,
  outer: SceneNode,
  child: LayoutNode,
  x: number,
  y: number,
  width: number,
  height: number,
): BoxMark {
  const { runs, hits, differences, heat } = builder.input;
  const mark = runs.get(child.path);
  const run = mark && closedPhase(mark);
  const loud = builder.isSelected(child.key)
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
