/** Routes of transitions: at right angles around the states between their ends, or over the author's waypoints. The search is
 * fast and local: it picks the cheapest of a few shapes for each line, given the lines before it. Lines to one target may share a
 * route, which merges them into a trunk; other lines keep apart. */

import { type Box, distance, type Point } from "../../model/geometry.ts";
import { freeWay } from "./free_way.ts";
import { type RoutingLanes, SHARED_FOR_UNIT } from "./routing_lanes.ts";

/** An end of a line. */
export interface RouteEnd {
  readonly at: Point;
  /** Unit vector that points out of the port. */
  readonly out: Point;
  /** Index of the box that has the port; -1 is the container. */
  readonly box: number;
}

export interface RouteRequest {
  readonly from: string;
  /** Target. Lines with equal targets may share a route. */
  readonly to: string;
  readonly start: RouteEnd;
  readonly goal: RouteEnd;
  /** Waypoints of the author. */
  readonly by: readonly Point[];
}

export interface Routed {
  readonly points: readonly Point[];
  /** Indices of the points that are waypoints of the author. */
  readonly waypoints: readonly number[];
  /** Index of the point before the longest piece without other lines beside it: the best position of a label. */
  readonly longest: number;
  /** Bounds of the points. */
  readonly box: Box;
}

/** Lines in the order of routing: those with waypoints first, then short ones before long ones. */
export function nearFirst<T extends RouteRequest>(lines: readonly T[]): readonly T[] {
  return lines
    .map((line, index) => ({ line, index, far: reach(line) }))
    .sort((one, other) => one.far - other.far || one.index - other.index)
    .map(({ line }) => line);
}

/** Route of a line, given the routes taken before. It is marked as taken itself. */
export function routed(line: RouteRequest, lanes: RoutingLanes): Routed {
  const way = line.by.length > 0 ? overWaypoints(line, lanes.pace) : cheapest(line, lanes);
  lanes.take(way.points, line.to);
  return way;
}

function reach({ start, goal, by }: RouteRequest): number {
  const far = Math.abs(start.at.x - goal.at.x) + Math.abs(start.at.y - goal.at.y);
  return by.length > 0 ? far - 1e9 : far;
}

/** Straight from point to point, with short pieces at the ports, as the reference draws it. */
function overWaypoints({ start, goal, by }: RouteRequest, pace: number): Routed {
  const [first = goal.at, last = start.at] = [by[0], by.at(-1)];
  const out = stub(start, Math.min(pace, distance(start.at, first) / 2));
  const into = stub(goal, Math.min(pace, distance(goal.at, last) / 2));
  const points = [start.at, out, ...by, into, goal.at];
  return {
    points,
    waypoints: by.map((_, index) => index + 2),
    longest: longestOf(points),
    box: boxOf(points),
  };
}

function stub({ at, out }: RouteEnd, length: number): Point {
  return { x: at.x + out.x * length, y: at.y + out.y * length };
}

/** Takes a simple shape at once if it crosses nothing; otherwise tries all channels near the line. */
function cheapest(line: RouteRequest, lanes: RoutingLanes): Routed {
  const short = Math.min(lanes.pace, distance(line.start.at, line.goal.at) / 3);
  const from = lanes.inFrame(stub(line.start, short));
  const to = lanes.inFrame(stub(line.goal, short));
  const best = new BestRoute(line, from, to, lanes);
  const middle = { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 };
  best.offer([{ x: to.x, y: from.y }]);
  best.offer([{ x: from.x, y: to.y }]);
  best.offer(acrossAt(middle.x, from, to));
  best.offer(alongAt(middle.y, from, to));
  if (!best.isFree && !lanes.isCrowded) {
    const { columns, rows } = lanes.channels(line, from, to);
    best.offerAll(columns, (x) => acrossAt(x, from, to));
    best.offerAll(rows, (y) => alongAt(y, from, to));
  }
  const points = aroundStates(best.points, line, lanes);
  return { points, waypoints: [], longest: lanes.longestAlone(points), box: boxOf(points) };
}

/** Another route if this one crosses a state and the search finds one. */
function aroundStates(
  points: readonly Point[],
  line: RouteRequest,
  lanes: RoutingLanes,
): readonly Point[] {
  if (lanes.isCrowded || !lanes.crosses(points)) return points;
  return freeWay(line, lanes) ?? points;
}

/** Number of successive channels that are too long after which the search stops. */
const TOO_LONG = 3;

/** The best route found until now. */
class BestRoute {
  points: readonly Point[] = [];
  isFree = false;
  #cost = Infinity;
  readonly #line: RouteRequest;
  readonly #from: Point;
  readonly #to: Point;
  readonly #lanes: RoutingLanes;
  /** Smallest share of its length that a route can cost, given the savings on shared parts. */
  readonly #share: number;

  constructor(line: RouteRequest, from: Point, to: Point, lanes: RoutingLanes) {
    this.#line = line;
    this.#from = from;
    this.#to = to;
    this.#lanes = lanes;
    this.#share = lanes.isShared(line.to) ? 1 - SHARED_FOR_UNIT : 1;
  }

  /** Tries these corners between the short pieces at the ports; false if they are too long to be cheaper. */
  offer(middle: readonly Point[]): boolean {
    const { start, goal } = this.#line;
    const points = withoutDetours([start.at, this.#from, ...middle, this.#to, goal.at]);
    const least = this.#lanes.least(points);
    if (least * this.#share >= this.#cost) return false;
    const cost = least + this.#lanes.penalty(points, this.#line, this.#cost - least);
    if (cost < this.#cost) {
      this.points = points;
      this.#cost = cost;
      this.isFree = cost <= least * 1.0001;
    }
    return true;
  }

  offerAll(channels: readonly number[], shape: (at: number) => readonly Point[]): void {
    let tooLong = 0;
    for (const at of channels) {
      tooLong = this.offer(shape(at)) ? 0 : tooLong + 1;
      if (tooLong >= TOO_LONG) return;
    }
  }
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

/** Removes points in the middle of straight pieces. Reversals stay, because they add cost. */
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

/** Index of the point where the longest piece begins. */
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

export function boxOf(points: readonly Point[]): Box {
  let [left, top, right, bottom] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const { x, y } of points) {
    if (x < left) left = x;
    if (x > right) right = x;
    if (y < top) top = y;
    if (y > bottom) bottom = y;
  }
  return { x: left, y: top, width: right - left, height: bottom - top };
}
