/** Connections inside a container: transitions with arrow heads and, where there is room, the name of the outcome; data flows as
 * a thinner layer below. */

import type { ElementKey } from "../../model/element.ts";
import type { Box, Point } from "../../model/geometry.ts";
import { ABORTED, PREEMPTED } from "../../model/machine.ts";
import type { LineMarkOfRun } from "../../store/run/marks.ts";
import { touches } from "../layout/grid.ts";
import type { RoutedLine } from "../layout/lines.ts";
import type { SceneBuilder, SceneNode } from "./builder.ts";
import { DETAIL, extent, fade, TEXT } from "./detail.ts";
import type { Ink, LineMark } from "./list.ts";
import { groundInk } from "./ring.ts";
import { faded } from "./runs.ts";

/** Margin around the view in which lines are drawn, in CSS pixels. */
const BEYOND = 30;

/** Adds the connections between the children. If routing is incomplete, known lines are drawn and another frame is requested. */
export function connectionMarks(builder: SceneBuilder, node: SceneNode): void {
  const alpha = fade(node.extent, DETAIL.content);
  if (alpha === 0) return;
  if (!node.at.wire(builder.input.mayRoute)) {
    builder.soon.push(node.at);
    builder.unfinished = true;
  }
  node.at.eachLine(builder.area(node, BEYOND), (line) => lineMarks(builder, node, line, alpha));
}

function lineMarks(builder: SceneBuilder, node: SceneNode, line: RoutedLine, alpha: number): void {
  const look = lookOf(builder, line);
  if (!look.loud && !isShown(builder, line)) return;
  const size = sizeOfEnd(node, line);
  if (!look.loud && size < DETAIL.tangle && size > 0) return;
  const mark = lineMark(node, line, look, size, alpha);
  const layer = builder.layer(node.depth + 1);
  if (look.loud) builder.layer(node.depth + 2).lines.push(mark);
  else if (line.kind === "transition" || isFocused(builder, line)) layer.lines.push(mark);
  else layer.under.push(mark);
  if (isStart(line) && size >= LEAST_FOR_START) startMark(builder, node, line, mark);
  if (line.kind === "transition") labelMark(builder, node, line, mark, look);
  if (builder.isSelected(line.key)) waypointMarks(builder, node, line);
}

interface LineLook {
  readonly ink: Ink;
  readonly width: number;
  /** True if the line is emphasized: selected, highlighted, different, or next in the run. */
  readonly loud: boolean;
  readonly dash?: boolean;
  readonly alpha?: number;
}

/** Style of a transition that the run took recently or takes next. */
function lookOfRun({ isNext, age }: LineMarkOfRun): LineLook {
  if (isNext) return { ink: "held", width: 2.75, loud: true, dash: true };
  const ink = age === 0 ? "running" : "trail";
  return { ink, width: age === 0 ? 2.75 : 2.25, loud: false, alpha: faded(age) };
}

function lookOf(builder: SceneBuilder, line: RoutedLine): LineLook {
  const { key, kind, outcome } = line;
  if (builder.isSelected(key)) return { ink: "selection", width: 2.5, loud: true };
  const isHovered = isThat(builder.input.hovered, key);
  const difference = builder.input.differences.get(key);
  if (builder.highlighted.has(key) || isHovered) {
    return { ink: kind === "transition" ? "highlight" : "data", width: 2.25, loud: true };
  }
  if (difference) return { ink: difference, width: 2, loud: true };
  const run = builder.input.taken.get(key);
  if (run) return lookOfRun(run);
  if (kind === "data_flow") return { ink: "flow", width: 1, loud: false };
  if (outcome === ABORTED) return { ink: "aborted-line", width: 1, loud: false };
  if (outcome === PREEMPTED) return { ink: "preempted-line", width: 1, loud: false };
  return { ink: "line", width: isStart(line) ? 2.2 : 1.4, loud: false };
}

/** True for the start transition of the container. */
function isStart({ kind, label }: RoutedLine): boolean {
  return kind === "transition" && label === "";
}

/** Smallest state that shows more than a line to it, in CSS pixels. */
const LEAST_FOR_START = 24;

/** Dot slightly inside the income. It marks the start of the container. */
function startMark(
  builder: SceneBuilder,
  node: SceneNode,
  line: RoutedLine,
  { points, alpha, ink }: LineMark,
): void {
  const [x, y, nextX, nextY] = points;
  if (x === undefined || y === undefined || nextX === undefined || nextY === undefined) return;
  const length = Math.hypot(nextX - x, nextY - y);
  const part = length === 0 ? 0 : Math.min(14, length / 2) / length;
  builder.layer(node.depth + 1).dots.push({
    what: `${line.key} start`,
    shape: "start",
    x: x + (nextX - x) * part,
    y: y + (nextY - y) * part,
    size: 9,
    toX: 0,
    toY: 0,
    fill: ink,
    stroke: null,
    alpha,
  });
}

function isThat(hovered: SceneBuilder["input"]["hovered"], key: ElementKey): boolean {
  if (!hovered || !("id" in hovered)) return false;
  return key === `${hovered.kind}:${hovered.path}:${hovered.id}`;
}

function isShown(builder: SceneBuilder, line: RoutedLine): boolean {
  const { dataFlows, transitions } = builder.input.modes;
  if (line.kind === "transition") return transitions;
  return dataFlows === "all" || (dataFlows === "selection" && isFocused(builder, line));
}

function isFocused({ focused }: SceneBuilder, line: RoutedLine): boolean {
  return focused.has(line.fromPath) || focused.has(line.toPath);
}

function lineMark(
  node: SceneNode,
  line: RoutedLine,
  look: LineLook,
  size: number,
  alpha: number,
): LineMark {
  const points: number[] = [];
  const step = stepOf(node, line);
  for (let index = 0; index < line.points.length; index += step) {
    const point = line.points[index];
    if (point) points.push(node.x + point.x * node.scale, node.y + point.y * node.scale);
  }
  const isTransition = line.kind === "transition";
  const far = look.loud || !isTransition ? 1 : Math.min(1, Math.max(0.35, size / DETAIL.lines));
  return {
    what: line.key,
    points,
    ink: look.ink,
    width: look.loud ? look.width : look.width * Math.max(0.7, far),
    radius: isTransition ? 6 : 0,
    curve: !isTransition && line.waypoints.length === 0,
    arrow: isTransition ? arrowOf(node, line, size) : look.loud ? 7 : 0,
    dash: look.dash ?? false,
    alpha: alpha * far * (look.alpha ?? 1),
  };
}

/** Step between the points that are drawn. Every fourth point suffices for a short curve. */
function stepOf(node: SceneNode, { kind, waypoints, box, points }: RoutedLine): number {
  if (kind === "transition" || waypoints.length > 0 || points.length % 4 !== 1) return 1;
  return Math.max(box.width, box.height) * node.scale < 90 ? 4 : 1;
}

/** Size of the target state on the screen. If the line ends at the container, size of the source state. */
function sizeOfEnd(node: SceneNode, line: RoutedLine): number {
  const child = node.at.child(line.toPath) ?? node.at.child(line.fromPath);
  if (!child) return 0;
  return extent({ width: child.box.width * node.scale, height: child.box.height * node.scale });
}

/** Length of the arrow head; 0 if a port is drawn in its place, or if the box is too small. */
function arrowOf(node: SceneNode, line: RoutedLine, size: number): number {
  if (size >= DETAIL.ports || size < 16 || line.toPath === node.at.path) return 0;
  return Math.min(7, size * 0.2);
}

/** Name of the outcome in the middle of the longest piece of the line without others beside it, if it fits. */
function labelMark(
  builder: SceneBuilder,
  node: SceneNode,
  line: RoutedLine,
  mark: LineMark,
  look: LineLook,
): void {
  if (line.label === "" || !builder.input.modes.portNames) return;
  const alpha = look.loud ? 1 : labelAlpha(node, line);
  if (alpha === 0) return;
  const width = builder.input.measure(line.label, TEXT.small, false);
  const fits = (at: Point) => look.loud || isClear(node, at, width);
  const at = labelPlace(mark.points, line.longest, width, fits);
  if (!at) return;
  const end = line.points.at(-1);
  builder.labels.push({
    what: `${line.key} label`,
    goal: `${line.toPath} ${end?.x} ${end?.y}`,
    ...at,
    text: line.label,
    size: TEXT.small,
    bold: false,
    ink: look.loud ? "text" : (LABEL_INKS[look.ink] ?? "soft"),
    align: "center",
    alpha,
    plate: groundInk(node),
    width,
  });
}

/** Half the height of a label, in CSS pixels. */
const HALF = 7;

/** True if a text of this width covers no state inside. */
export function isClear(node: SceneNode, at: Point, width: number, around = NO_PLATE): boolean {
  let clear = true;
  node.at.eachChild(areaOf(node, at, width, around), () => {
    clear = false;
  });
  return clear;
}

/** True if no transition runs through a text of this width and its plate. */
export function isOffLines(node: SceneNode, at: Point, width: number): boolean {
  const area = areaOf(node, at, width, PLATE);
  let isOff = true;
  node.at.eachLine(area, ({ kind, points }) => {
    if (kind !== "transition" || !isOff) return;
    isOff = !points.some((to, index) => {
      const from = points[index - 1];
      return from !== undefined && touches(boxOf(from, to), area);
    });
  });
  return isOff;
}

/** Margins of the plate behind a text, with some extra space, in CSS pixels. */
export const PLATE = { beside: 5, above: 2 };
const NO_PLATE = { beside: 0, above: 0 };

function areaOf({ x, y, scale }: SceneNode, at: Point, width: number, around: typeof PLATE): Box {
  const [wide, high] = [width + 2 * around.beside, 2 * (HALF + around.above)];
  return {
    x: (at.x - wide / 2 - x) / scale,
    y: (at.y - high / 2 - y) / scale,
    width: wide / scale,
    height: high / scale,
  };
}

function boxOf(from: Point, to: Point): Box {
  const [x, y] = [Math.min(from.x, to.x), Math.min(from.y, to.y)];
  return { x, y, width: Math.abs(to.x - from.x), height: Math.abs(to.y - from.y) };
}

/** Middle of the best piece; otherwise of the first horizontal piece with enough length and room. */
function labelPlace(
  points: readonly number[],
  best: number,
  width: number,
  fits: (at: Point) => boolean,
): Point | null {
  const found = middleOf(points, best, width);
  const isRoomy = found !== null && fits(found.at);
  if (found?.lying && isRoomy) return found.at;
  for (let index = 0; index < points.length / 2 - 1; index++) {
    const other = middleOf(points, index, width);
    if (other?.lying && fits(other.at)) return other.at;
  }
  return isRoomy ? found.at : null;
}

function middleOf(points: readonly number[], index: number, width: number) {
  const [fromX, fromY, toX, toY] = points.slice(index * 2, index * 2 + 4);
  if (fromX === undefined || fromY === undefined || toX === undefined || toY === undefined) {
    return null;
  }
  const lying = Math.abs(toX - fromX) >= Math.abs(toY - fromY);
  if (lying ? Math.abs(toX - fromX) < width + 16 : Math.abs(toY - fromY) < 34) return null;
  return { lying, at: { x: (fromX + toX) / 2, y: (fromY + toY) / 2 } };
}

/** Opacity of a label. Labels appear with the states that their lines leave, and disappear when these show the names of their
 * outcomes. */
function labelAlpha(node: SceneNode, line: RoutedLine): number {
  const child = node.at.child(line.fromPath);
  if (!child) return 0;
  const [width, height] = [child.box.width * node.scale, child.box.height * node.scale];
  const size = extent({ width, height });
  return size >= DETAIL.labels ? 0 : fade(size, DETAIL.lines);
}

const LABEL_INKS: Readonly<Record<string, Ink>> = {
  "aborted-line": "aborted",
  "preempted-line": "preempted",
};

/** Handles of a selected connection: its ends, its waypoints, and the middles of its pieces. */
function waypointMarks(builder: SceneBuilder, node: SceneNode, line: RoutedLine): void {
  const layer = builder.layer(node.depth + 2);
  const put = (index: number, shape: "waypoint" | "handle") => {
    const point = line.points[index];
    if (!point) return;
    layer.dots.push({
      what: `${line.key} ${shape} ${index}`,
      shape,
      x: node.x + point.x * node.scale,
      y: node.y + point.y * node.scale,
      size: 7,
      toX: 0,
      toY: 0,
      fill: "handle",
      stroke: "selection",
      alpha: 1,
    });
  };
  put(0, "handle");
  put(line.points.length - 1, "handle");
  for (const index of line.waypoints) put(index, "waypoint");
}
