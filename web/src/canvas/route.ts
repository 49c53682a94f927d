/** Ways of transitions: at right angles around the states between their ends, or over the author's waypoints. Quick and
 * local: of a few shapes for each line the one that costs least, after the lines before it. What leads to one target shares
 * its way there, and so many lines become one trunk; others keep apart. */

import { around, type Box, type Point, type Size } from "../model/geometry.ts";
import { Lanes } from "./lanes.ts";

/** Where a line begins or ends. */
export interface End {
  readonly at: Point;
  /** The way out of the port, one long. */
  readonly out: Point;
  /** Which of the boxes has the port; -1: the container. */
  readonly box: number;
}

export interface Wanted {
  readonly from: string;
  /** Lines to the same target may share a way. */
  readonly to: string;
  readonly start: End;
  readonly goal: End;
  /** The author's waypoints. */
  readonly by: readonly Point[];
}

export interface Routed {
  readonly points: readonly Point[];
  readonly waypoints: readonly number[];
  readonly longest: number;
  readonly box: Box;
}

interface Known {
  readonly to: string;
  readonly points: readonly Point[];
}

/** The ways of all lines of a container of this size, in their order. */
export function routed(
  wanted: readonly Wanted[],
  boxes: readonly Box[],
  frame: Size,
  known: readonly Known[],
): readonly Routed[] {
  const lanes = new Lanes(boxes, frame);
  for (const { points, to } of known) lanes.take(points, to);
  const ways: Routed[] = new Array(wanted.length);
  const nearFirst = wanted
    .map((line, index) => ({ line, index, far: reach(line) }))
    .sort((one, other) => one.far - other.far || one.index - other.index);
  for (const { line, index } of nearFirst) {
    const way = line.by.length > 0 ? overWaypoints(line, lanes.pace) : cheapest(line, lanes);
    lanes.take(way.points, line.to);
    ways[index] = way;
  }
  return ways;
}

function reach({ start, goal, by }: Wanted): number {
  const far = Math.abs(start.at.x - goal.at.x) + Math.abs(start.at.y - goal.at.y);
  return by.length > 0 ? far - 1e9 : far;
}

/** As the reference draws it: straight from point to point, with short pieces out of the ports. */
function overWaypoints({ start, goal, by }: Wanted, pace: number): Routed {
  const points = [start.at, stub(start, pace), ...by, stub(goal, pace), goal.at];
  return {
    points,
    waypoints: by.map((_, index) => index + 2),
    longest: longestOf(points),
    box: boxOf(points),
  };
}

function stub({ at, out }: End, length: number): Point {
  return { x: at.x + out.x * length, y: at.y + out.y * length };
}

function cheapest(line: Wanted, lanes: Lanes): Routed {
  const [from, to] = [stub(line.start, lanes.pace), stub(line.goal, lanes.pace)];
  let best: readonly Point[] = [];
  let cost = Infinity;
  for (const middle of shapes(line, from, to, lanes)) {
    const points = withoutDetours([line.start.at, from, ...middle, to, line.goal.at]);
    const now = lanes.cost(points, line, cost);
    if (now < cost) [best, cost] = [points, now];
  }
  return { points: best, waypoints: [], longest: lanes.longestAlone(best), box: boxOf(best) };
}

/** Corners between the ends of the short pieces, likely ones first. */
function* shapes(line: Wanted, from: Point, to: Point, lanes: Lanes): Generator<readonly Point[]> {
  yield [{ x: to.x, y: from.y }];
  yield [{ x: from.x, y: to.y }];
  const middle = { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 };
  yield acrossAt(middle.x, from, to);
  yield alongAt(middle.y, from, to);
  const { columns, rows } = lanes.channels(line, from, to);
  for (const x of columns) yield acrossAt(x, from, to);
  for (const y of rows) yield alongAt(y, from, to);
}

function acrossAt(x: number, from: Point, to: Point): readonly Point[] {
  return [
    { x, y: from.y },
    { x, y: to.y },
  ];
}

function alongAt(y: number, from: Point, to: Point): readonly Point[] {
  return [
    { x: from.x, y },
    { x: to.x, y },
  ];
}

/** Without points in the middle of a straight piece. What turns back stays: it costs. */
function withoutDetours(points: readonly Point[]): readonly Point[] {
  const kept: Point[] = [];
  for (const point of points) {
    const last = kept.at(-1);
    if (last && last.x === point.x && last.y === point.y) continue;
    const before = kept.at(-2);
    if (last && before && onTheWay(before, last, point)) kept.pop();
    kept.push(point);
  }
  return kept;
}

function onTheWay(before: Point, point: Point, after: Point): boolean {
  if (before.x === point.x && point.x === after.x) {
    return Math.sign(point.y - before.y) === Math.sign(after.y - point.y);
  }
  if (before.y === point.y && point.y === after.y) {
    return Math.sign(point.x - before.x) === Math.sign(after.x - point.x);
  }
  return false;
}

/** The point that the longest piece begins at. */
export function longestOf(points: readonly Point[]): number {
  let [best, longest] = [0, -1];
  for (let index = 0; index + 1 < points.length; index++) {
    const [one, other] = [points[index], points[index + 1]];
    if (!one || !other) continue;
    const length = Math.hypot(other.x - one.x, other.y - one.y);
    if (length > longest) [best, longest] = [index, length];
  }
  return best;
}

function boxOf(points: readonly Point[]): Box {
  const found = around(points.map(({ x, y }) => ({ x, y, width: 0, height: 0 })));
  return found ?? { x: 0, y: 0, width: 0, height: 0 };
}
