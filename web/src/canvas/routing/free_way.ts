/** Search for a route around states, used if every simple shape of a line crosses a state. The grid has columns and rows beside
 * the states near the ends. */

import type { Box, Point } from "../../model/geometry.ts";
import type { RouteRequest } from "./route.ts";
import type { RoutingLanes } from "./routing_lanes.ts";

/** Maximum number of states that add columns and rows to the grid. */
const BOXES_MAX = 48;
/** Maximum number of grid points that a search visits. */
const VISITS_MAX = 20_000;
/** Cost of a bend, in paces. */
const BEND = 1.5;

/** Right, down, left, up. */
const DIRECTIONS: readonly Point[] = [
  { x: 1, y: 0 },
  { x: 0, y: 1 },
  { x: -1, y: 0 },
  { x: 0, y: -1 },
];

/** Corners of the cheapest way through no state; null if none is found. */
export function freeWay(line: RouteRequest, lanes: RoutingLanes): readonly Point[] | null {
  const boxes = lanes.boxesNear(line, BOXES_MAX);
  return new WaySearch(line, lanes, boxes).run();
}

interface SearchStep {
  readonly state: number;
  /** Index of the previous search state; -1 at the start. */
  readonly before: number;
  readonly cost: number;
  /** Cost until here plus the lowest possible cost to the goal. */
  readonly total: number;
}

/** A* over grid points and arrival directions. */
class WaySearch {
  readonly #line: RouteRequest;
  readonly #lanes: RoutingLanes;
  readonly #columns: readonly number[];
  readonly #rows: readonly number[];
  readonly #queue = new Queue();
  readonly #before = new Map<number, number>();

  constructor(line: RouteRequest, lanes: RoutingLanes, boxes: readonly Box[]) {
    this.#line = line;
    this.#lanes = lanes;
    const { frame, pace } = lanes;
    const { start, goal } = line;
    const sides = boxes.flatMap(({ x, width }) => [x, x + width]);
    this.#columns = between(sides, frame.width, pace, [start.at.x, goal.at.x]);
    const ends = boxes.flatMap(({ y, height }) => [y, y + height]);
    this.#rows = between(ends, frame.height, pace, [start.at.y, goal.at.y]);
  }

  run(): readonly Point[] | null {
    const { start, goal } = this.#line;
    const first = this.#state(start.at, directionOf(start.out));
    const last = this.#state(goal.at, directionOf({ x: -goal.out.x, y: -goal.out.y }));
    this.#queue.push({ state: first, before: -1, cost: 0, total: 0 });
    for (let count = 0; count < VISITS_MAX; count++) {
      const visit = this.#queue.pop();
      if (!visit) return null;
      if (this.#before.has(visit.state)) continue;
      this.#before.set(visit.state, visit.before);
      if (visit.state === last) return this.#corners(last);
      this.#spread(visit, visit.state === first);
    }
    return null;
  }

  /** The line leaves its port straight, and never reverses. */
  #spread({ state, cost }: SearchStep, isFirst: boolean): void {
    const direction = state & 3;
    for (const turn of isFirst ? [0] : [0, 1, 3]) {
      this.#step(state, cost, (direction + turn) & 3, turn !== 0);
    }
  }

  #step(state: number, cost: number, direction: number, isBend: boolean): void {
    const { x, y } = DIRECTIONS[direction] ?? { x: 0, y: 0 };
    const [column, row] = this.#cell(state);
    const next = this.#stateAt(column + x, row + y, direction);
    if (next === null || this.#before.has(next)) return;
    const [from, to] = [this.#point(state), this.#point(next)];
    const price = this.#lanes.stepCost(from, to, this.#line.to);
    if (price === null) return;
    const sum = cost + price + (isBend ? BEND * this.#lanes.pace : 0);
    const { at } = this.#line.goal;
    const left = Math.abs(to.x - at.x) + Math.abs(to.y - at.y);
    this.#queue.push({ state: next, before: state, cost: sum, total: sum + left });
  }

  #state(at: Point, direction: number): number {
    const column = this.#columns.indexOf(at.x);
    return (column * this.#rows.length + this.#rows.indexOf(at.y)) * 4 + direction;
  }

  #stateAt(column: number, row: number, direction: number): number | null {
    const [columns, rows] = [this.#columns.length, this.#rows.length];
    if (column < 0 || row < 0 || column >= columns || row >= rows) return null;
    return (column * rows + row) * 4 + direction;
  }

  #cell(state: number): readonly [number, number] {
    const cell = state >> 2;
    return [Math.floor(cell / this.#rows.length), cell % this.#rows.length];
  }

  #point(state: number): Point {
    const [column, row] = this.#cell(state);
    return { x: this.#columns[column] ?? 0, y: this.#rows[row] ?? 0 };
  }

  /** Both ends, and the points at which the direction changes. */
  #corners(last: number): readonly Point[] {
    const points = [this.#point(last)];
    for (let state = last; ; ) {
      const before = this.#before.get(state) ?? -1;
      if (before < 0) return [...points, this.#point(state)].reverse();
      if ((before & 3) !== (state & 3)) points.push(this.#point(before));
      state = before;
    }
  }
}

function directionOf(out: Point): number {
  return DIRECTIONS.findIndex(({ x, y }) => x === out.x && y === out.y) & 3;
}

/** Sorted coordinates beside and between the borders, and the additional ones. */
function between(
  borders: readonly number[],
  length: number,
  pace: number,
  more: readonly number[],
): readonly number[] {
  const inside = borders.filter((at) => at > 0 && at < length);
  const sorted = [0, ...inside.sort((one, other) => one - other), length];
  const found = [...more];
  for (const [index, low] of sorted.entries()) {
    const high = sorted[index + 1] ?? low;
    if (high - low > 3 * pace) found.push(low + pace, high - pace);
    else if (high > low) found.push((low + high) / 2);
  }
  return [...new Set(found)].sort((one, other) => one - other);
}

/** Binary heap with the lowest total first. */
class Queue {
  readonly #heap: SearchStep[] = [];

  push(visit: SearchStep): void {
    const heap = this.#heap;
    let at = heap.push(visit) - 1;
    while (at > 0) {
      const up = (at - 1) >> 1;
      const parent = heap[up];
      if (!parent || parent.total <= visit.total) break;
      heap[at] = parent;
      at = up;
    }
    heap[at] = visit;
  }

  pop(): SearchStep | undefined {
    const heap = this.#heap;
    const [first] = heap;
    const last = heap.pop();
    if (first && last && first !== last) this.#sink(last);
    return first;
  }

  #sink(visit: SearchStep): void {
    const heap = this.#heap;
    let at = 0;
    for (;;) {
      const [left, right] = [heap[2 * at + 1], heap[2 * at + 2]];
      const isRight = left && right && right.total < left.total;
      const child = isRight ? right : left;
      if (!child || child.total >= visit.total) break;
      heap[at] = child;
      at = 2 * at + (isRight ? 2 : 1);
    }
    heap[at] = visit;
  }
}
