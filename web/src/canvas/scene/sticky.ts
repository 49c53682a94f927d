/** Border of a state that fills the view, drawn as a frame at the view's edges. It keeps the ports of the state visible and
 * clickable. */

import type { Point, Side, Size } from "../../model/geometry.ts";
import { sideOf } from "../../model/geometry.ts";
import type { PortPlace } from "../../model/layout_reader.ts";
import type { Camera } from "../../store/page/view.ts";
import type { LayoutNode } from "../layout/layout_node.ts";
import type { LayoutTree, NodeFrame } from "../layout/layout_tree.ts";
import { inside } from "../layout/layout_tree.ts";
import { type SceneBuilder, shade } from "./builder.ts";
import { TEXT } from "./detail.ts";
import type { DotMark, Ink, Layer, TextMark } from "./list.ts";
import { portInk, SHAPES } from "./ports.ts";
import { groundInk } from "./ring.ts";
import { cut } from "./words.ts";

/** Width of the frame, in CSS pixels. */
export const FRAME = 10;

interface StickyPort {
  readonly port: PortPlace;
  /** Position in CSS pixels of the view. */
  readonly at: Point;
  readonly side: Side;
}

interface Sticky {
  readonly state: LayoutNode;
  readonly ports: readonly StickyPort[];
}

/** Innermost state around the whole view, with its ports at the view's edges; null if a border is visible. */
export function stickyFrame(layout: LayoutTree, camera: Camera, view: Size): Sticky | null {
  let found: NodeFrame | null = null;
  let next: NodeFrame | null = layout.root && { at: layout.root, x: 0, y: 0, unit: 1 };
  while (next && fills(next, camera, view)) {
    found = next;
    next = childAround(next, camera, view);
  }
  return found && stuck(found, camera, view);
}

function fills({ at, x, y, unit }: NodeFrame, camera: Camera, view: Size): boolean {
  const { width, height } = at.size;
  return (
    x < camera.x &&
    y < camera.y &&
    x + width * unit > camera.x + view.width / camera.scale &&
    y + height * unit > camera.y + view.height / camera.scale
  );
}

function childAround(frame: NodeFrame, camera: Camera, view: Size): NodeFrame | null {
  for (const child of frame.at.children) {
    const inner = inside(frame, child);
    if (fills(inner, camera, view)) return inner;
  }
  return null;
}

function stuck(frame: NodeFrame, camera: Camera, view: Size): Sticky {
  const ports = frame.at.ports.map((port) => {
    const side = sideOf(port.at, frame.at.size);
    const x = (frame.x + port.at.x * frame.unit - camera.x) * camera.scale;
    const y = (frame.y + port.at.y * frame.unit - camera.y) * camera.scale;
    return { port, side, at: onEdge(side, x, y, view) };
  });
  return { state: frame.at, ports: apart(ports) };
}

function onEdge(side: Side, x: number, y: number, view: Size): Point {
  const half = FRAME / 2;
  const across = Math.min(view.width - 4 * FRAME, Math.max(4 * FRAME, x));
  const down = Math.min(view.height - 4 * FRAME, Math.max(4 * FRAME, y));
  switch (side) {
    case "left":
      return { x: half, y: down };
    case "right":
      return { x: view.width - half, y: down };
    case "top":
      return { x: across, y: half };
    case "bottom":
      return { x: across, y: view.height - half };
  }
}

const PITCH = 18;

/** Moves overlapping ports apart along their edge: downwards or to the left. */
function apart(ports: readonly StickyPort[]): readonly StickyPort[] {
  const placed: StickyPort[] = [];
  for (const port of ports) {
    const isUpright = port.side === "left" || port.side === "right";
    let at = port.at;
    const along = (point: Point) => (isUpright ? point.y : point.x);
    const isTaken = () =>
      placed.some(
        (other) => other.side === port.side && Math.abs(along(other.at) - along(at)) < PITCH,
      );
    for (let tries = 0; isTaken() && tries < ports.length; tries++) {
      at = isUpright ? { x: at.x, y: at.y + PITCH } : { x: at.x - PITCH * 4, y: at.y };
    }
    placed.push({ ...port, at });
  }
  return placed;
}

export function stickyMarks(builder: SceneBuilder): void {
  const { layout, camera, view } = builder.input;
  const node = builder.covering;
  const sticky = node && stickyFrame(layout, camera, view);
  if (!sticky) return;
  const layer = builder.top();
  edges(builder, layer, shade(node.depth + 1));
  for (const port of sticky.ports) {
    layer.dots.push(stuckDot(builder, port));
    const isBeside = port.side === "left" || port.side === "right";
    const named = builder.input.modes.portNames && port.port.kind !== "income" && isBeside;
    if (named) builder.portNames.push(stuckName(builder, port, groundInk(node)));
  }
}

const OUT = { left: [-1, 0], right: [1, 0], top: [0, -1], bottom: [0, 1] } as const;

function stuckDot(builder: SceneBuilder, { port, at, side }: StickyPort): DotMark {
  const [x, y] = OUT[side];
  const sign = port.kind === "income" || port.kind === "input" ? -1 : 1;
  return {
    what: `${port.key} sticky`,
    shape: SHAPES[port.kind],
    ...at,
    size: 9,
    toX: sign * x,
    toY: sign * y,
    fill: portInk(port),
    stroke: builder.highlighted.has(port.key) ? "highlight" : null,
    alpha: 1,
  };
}

function stuckName(builder: SceneBuilder, { port, at, side }: StickyPort, plate: Ink): TextMark {
  const { measure } = builder.input;
  const text = cut(port.name, 140, TEXT.small, false, measure);
  return {
    what: `${port.key} sticky name`,
    x: at.x + (side === "left" ? 1 : -1) * (FRAME / 2 + 6),
    y: at.y,
    text,
    size: TEXT.small,
    bold: false,
    ink: port.kind === "outcome" ? "soft" : "data-text",
    align: side === "left" ? "left" : "right",
    alpha: 1,
    plate,
    width: measure(text, TEXT.small, false),
  };
}

function edges(builder: SceneBuilder, layer: Layer, ground: string): void {
  const { width, height } = builder;
  const strips = [
    [0, 0, width, FRAME],
    [0, height - FRAME, width, FRAME],
    [0, FRAME, FRAME, height - 2 * FRAME],
    [width - FRAME, FRAME, FRAME, height - 2 * FRAME],
  ] as const;
  for (const [x, y, wide, high] of strips) {
    layer.specks.push({
      what: "frame",
      x,
      y,
      width: wide,
      height: high,
      radius: 0,
      fill: ground,
      stroke: null,
      line: 0,
      dash: false,
      alpha: 1,
    });
  }
  layer.boxes.push({
    what: "frame",
    x: FRAME,
    y: FRAME,
    width: width - 2 * FRAME,
    height: height - 2 * FRAME,
    radius: 6,
    fill: null,
    stroke: "outline",
    line: 1,
    dash: false,
    alpha: 1,
  });
}
