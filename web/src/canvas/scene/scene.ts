/** What can be seen of a machine, in which detail: pure, from the camera to a list of marks. */

import type { PlacedState } from "../tree.ts";
import { connectionMarks } from "./connections.ts";
import { DETAIL, extent, SPECK } from "./detail.ts";
import { Drawing, type Spot, shade } from "./drawing.ts";
import { gestureMarks } from "./gesture.ts";
import type { SceneInput } from "./input.ts";
import type { BoxMark, DrawList } from "./list.ts";
import { nameMarks } from "./names.ts";
import { portMarks } from "./ports.ts";
import { stateMarks } from "./states.ts";
import { stickyMarks } from "./sticky.ts";

/** So far beyond the view something may still reach into it. */
const REACH = 12;

export function scene(input: SceneInput): DrawList {
  const drawing = new Drawing(input);
  const { root } = input.placed;
  if (root) {
    visit(drawing, rootSpot(root, input), NOTHING);
    stickyMarks(drawing);
    gestureMarks(drawing);
  }
  return { layers: drawing.layers, wanted: drawing.wanted, unfinished: drawing.unfinished };
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
  stateMarks(drawing, spot);
  const children = shownChildren(drawing, spot);
  const joined = joinedBy(spot, children !== null);
  if (children) {
    connectionMarks(drawing, spot);
    for (const child of children) visitChild(drawing, spot, child, joined);
  }
  if (covers(drawing, spot)) drawing.covering ??= spot;
  else {
    portMarks(drawing, spot, outerJoined(connected, joined), children !== null);
    nameMarks(drawing, spot, children !== null);
  }
}

/** The children, if the state is large enough to show them; null if it has none, or shows none. */
function shownChildren(drawing: Drawing, spot: Spot): readonly PlacedState[] | null {
  if (spot.extent < DETAIL.content) return null;
  const { children } = spot.at;
  if (spot.at.opened && children.length === 0) drawing.wanted.push(spot.at.path);
  return children.length === 0 ? null : children;
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
  if (!drawing.sees(x, y, width, height, REACH)) return;
  const size = extent({ width, height });
  if (size < DETAIL.box) {
    if (size >= SPECK)
      drawing.layer(outer.depth + 1).specks.push(speck(drawing, outer, child, x, y, width, height));
    return;
  }
  visit(drawing, spotOf(child, x, y, outer.scale * child.scale, outer.depth + 1, outer), joined);
}

/** A state too small for more than a colour: that of how it runs, or of its depth. */
function speck(
  drawing: Drawing,
  outer: Spot,
  child: PlacedState,
  x: number,
  y: number,
  width: number,
  height: number,
): BoxMark {
  const { runs, hits, differences } = drawing.input;
  const run = runs.get(child.path)?.phase;
  const loud = drawing.isSelected(child.key)
    ? "selection"
    : (differences.get(child.key) ?? (hits.has(child.key) ? "hit" : undefined));
  const fill = loud ?? (run === undefined ? shade(outer.depth + 2) : (RUN_INKS[run] ?? "running"));
  return {
    what: child.key,
    x,
    y,
    width,
    height,
    radius: 0,
    fill,
    stroke: null,
    line: 0,
    dash: false,
    alpha: 1,
  };
}

const RUN_INKS: Readonly<Record<string, string>> = {
  running: "running",
  waiting: "waiting",
  held: "held",
  failed: "aborted",
  preempted: "preempted",
  trail: "trail",
};

/** Ports that transitions of the container join, as far as that is known. */
function joinedBy(spot: Spot, open: boolean): ReadonlySet<string> {
  return open && spot.at.hasLines ? spot.at.joined : NOTHING;
}

function outerJoined(outer: ReadonlySet<string>, own: ReadonlySet<string>): ReadonlySet<string> {
  return own.size === 0 ? outer : outer.size === 0 ? own : new Set([...outer, ...own]);
}

/** Whether nothing of the state's border is in the view. */
function covers({ width, height }: Drawing, spot: Spot): boolean {
  return spot.x < 0 && spot.y < 0 && spot.x + spot.width > width && spot.y + spot.height > height;
}
