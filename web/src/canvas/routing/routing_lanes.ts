/** The area between the states of a container: the cost of a route through it, and the routes that are taken. */

import type { Box, Point, Size } from "../../model/geometry.ts";
import type { Grid } from "../layout/grid.ts";
import type { RouteRequest } from "./route.ts";

/** A vertical or horizontal piece of a line. */
interface Piece {
  readonly at: number;
  readonly from: number;
  readonly to: number;
  readonly group: string;
}

/** Number of pieces from which lines ignore each other. Nobody could distinguish so dense lines. */
const MANY_LINES = 160;
/** Number of states above which only the simplest shapes are tried. Nobody could follow a line among more. */
const MANY_BOXES = 800;
/** Largest number of boxes that add channels, and channels beside each side of a box. */
const NEAR_BOXES = 10;
const BESIDE = 3;

const BEND = 1.5;
const TURN_BACK = 40;
const THROUGH = 12;
const THROUGH_FOR_UNIT = 4;
const GRAZE_FOR_UNIT = 0.6;
const OVER_OTHER_FOR_UNIT = 3;
const CROSS = 0.8;
/** Saving per unit of length that a line shares with others to its target. */
export const SHARED_FOR_UNIT = 0.75;
const OUTSIDE = 60;
/** Rounding error, in paces. */
const TINY = 1e-6;
const NOTHING: Box = { x: 0, y: 0, width: 0, height: 0 };

export class RoutingLanes {
  /** Distance of lines from states and from each other. */
  readonly pace: number;
  readonly #boxes: readonly Box[];
  readonly frame: Size;
  readonly #grid: Grid;
  readonly #groups = new Set<string>();
  readonly #lying: Piece[] = [];
  readonly #standing: Piece[] = [];

  /** `grid` is the index of `boxes`. */
  constructor(boxes: readonly Box[], frame: Size, grid: Grid) {
    this.#boxes = boxes;
    this.frame = frame;
    this.#grid = grid;
    this.pace = paceOf(boxes, frame);
  }

  get isCrowded(): boolean {
    return this.#boxes.length > MANY_BOXES;
  }

  /** True if a route to this target is taken. */
  isShared(group: string): boolean {
    return this.#groups.has(group);
  }

  /** Marks the route as taken. */
  take(points: readonly Point[], group: string): void {
    if (this.#lying.length + this.#standing.length > MANY_LINES) return;
    this.#groups.add(group);
    for (let index = 0; index + 1 < points.length; index++) {
      const [one, other] = [points[index], points[index + 1]];
      if (!one || !other) continue;
      if (one.y === other.y) this.#lying.push(piece(one.y, one.x, other.x, group));
      else if (one.x === other.x) this.#standing.push(piece(one.x, one.y, other.y, group));
    }
  }

  /** Lower bound of the cost of a route: its length, bends and reversals. */
  least(points: readonly Point[]): number {
    let cost = (points.length - 2) * BEND * this.pace + turnsBack(points) * TURN_BACK * this.pace;
    for (let index = 0; index + 1 < points.length; index++) {
      const [one, other] = [points[index], points[index + 1]];
      if (one && other) cost += Math.abs(one.x - other.x) + Math.abs(one.y - other.y);
    }
    return cost;
  }

  /** Additional cost of a route for states and lines in its way; negative where it shares a route. The sum stops at `enough`. */
  penalty(points: readonly Point[], line: RouteRequest, enough: number): number {
    let cost = 0;
    for (let index = 0; index + 1 < points.length; index++) {
      const [one, other] = [points[index], points[index + 1]];
      if (!one || !other) continue;
      cost += this.#pieceCost(one, other, index, points.length, line);
      if (cost >= enough) return cost;
    }
    return cost;
  }

  #pieceCost(one: Point, other: Point, index: number, count: number, line: RouteRequest): number {
    const length = Math.abs(one.x - other.x) + Math.abs(one.y - other.y);
    const lying = one.y === other.y;
    const at = lying ? one.y : one.x;
    const from = lying ? Math.min(one.x, other.x) : Math.min(one.y, other.y);
    const spared = index === 0 ? line.start.box : index === count - 2 ? line.goal.box : -1;
    const outside = this.#isOutside(at, lying) ? OUTSIDE * this.pace : 0;
    const boxes = this.#boxCost(lying, at, from, from + length, spared);
    return outside + boxes + this.#othersCost(lying, at, from, from + length, line.to);
  }

  #isOutside(at: number, lying: boolean): boolean {
    return at < 0 || at > (lying ? this.frame.height : this.frame.width);
  }

  #boxCost(lying: boolean, at: number, from: number, to: number, spared: number): number {
    const near = this.pace * 0.6;
    const area = lying
      ? { x: from, y: at - near, width: to - from, height: 2 * near }
      : { x: at - near, y: from, width: 2 * near, height: to - from };
    let cost = 0;
    this.#grid.each(area, (index) => {
      const box = this.#boxes[index];
      if (!box || index === spared) return;
      const [low, high] = lying ? [box.y, box.y + box.height] : [box.x, box.x + box.width];
      const [first, last] = lying ? [box.x, box.x + box.width] : [box.y, box.y + box.height];
      const shared = Math.min(to, last) - Math.max(from, first);
      if (shared <= 0 || at <= low - near || at >= high + near) return;
      const through = at > low && at < high;
      cost += through ? THROUGH * this.pace + shared * THROUGH_FOR_UNIT : shared * GRAZE_FOR_UNIT;
    });
    return cost;
  }

  #othersCost(lying: boolean, at: number, from: number, to: number, group: string): number {
    const beside = lying ? this.#lying : this.#standing;
    const across = lying ? this.#standing : this.#lying;
    if (beside.length + across.length > MANY_LINES) return 0;
    let cost = 0;
    let shared = 0;
    for (const other of beside) {
      if (Math.abs(other.at - at) >= this.pace * 0.45) continue;
      const both = Math.min(to, other.to) - Math.max(from, other.from);
      if (both <= 0) continue;
      if (other.group !== group) cost += both * OVER_OTHER_FOR_UNIT;
      else if (other.at === at) shared = Math.max(shared, both);
    }
    for (const other of across) {
      if (other.group === group || other.at <= from || other.at >= to) continue;
      if (other.from < at && other.to > at) cost += CROSS * this.pace;
    }
    return cost - shared * SHARED_FOR_UNIT;
  }

  /** Nearest point inside the container. */
  inFrame({ x, y }: Point): Point {
    const { width, height } = this.frame;
    return { x: Math.min(Math.max(x, 0), width), y: Math.min(Math.max(y, 0), height) };
  }

  /** True for a route through a state. */
  crosses(points: readonly Point[]): boolean {
    return points.some((one, index) => {
      const other = points[index + 1];
      return other !== undefined && this.#isThrough(one, other);
    });
  }

  /** True for an upright or level piece through a state; a piece along the border counts as outside. */
  #isThrough(one: Point, other: Point): boolean {
    const least = this.pace * TINY;
    let through = false;
    this.#grid.each(boxOf(one, other), (index) => {
      const { x, y, width, height } = this.#boxes[index] ?? NOTHING;
      const wide =
        Math.min(Math.max(one.x, other.x), x + width) - Math.max(Math.min(one.x, other.x), x);
      const high =
        Math.min(Math.max(one.y, other.y), y + height) - Math.max(Math.min(one.y, other.y), y);
      const inside =
        one.y === other.y
          ? wide > least && one.y > y + least && one.y < y + height - least
          : high > least && one.x > x + least && one.x < x + width - least;
      through ||= inside;
    });
    return through;
  }

  /** Cost of a step beside states and other lines; null through a state. */
  stepCost(one: Point, other: Point, group: string): number | null {
    if (this.#isThrough(one, other)) return null;
    const lying = one.y === other.y;
    const at = lying ? one.y : one.x;
    const from = lying ? Math.min(one.x, other.x) : Math.min(one.y, other.y);
    const to = lying ? Math.max(one.x, other.x) : Math.max(one.y, other.y);
    const others = this.#othersCost(lying, at, from, to + this.pace * TINY, group);
    return to - from + Math.max(0, this.#boxCost(lying, at, from, to, -1) + others);
  }

  /** States around the ends of a line, first those between the ends. */
  boxesNear(line: RouteRequest, most: number): readonly Box[] {
    const between = boxOf(line.start.at, line.goal.at);
    for (const part of [2, 1, 0.5, 0.1]) {
      const by = part * Math.max(between.width, between.height) + 4 * this.pace;
      const found: Box[] = [];
      const area = {
        x: between.x - by,
        y: between.y - by,
        width: between.width + 2 * by,
        height: between.height + 2 * by,
      };
      this.#grid.each(area, (index) => {
        const box = this.#boxes[index];
        if (box) found.push(box);
      });
      if (found.length <= most) return found;
    }
    return [];
  }

  /** Columns and rows that a route may use, the shortest first. */
  channels(
    line: RouteRequest,
    from: Point,
    to: Point,
  ): { readonly columns: readonly number[]; readonly rows: readonly number[] } {
    const columns = [from.x, to.x];
    const rows = [from.y, to.y];
    for (const { at, group } of this.#standing) if (group === line.to) columns.push(at);
    for (const { at, group } of this.#lying) if (group === line.to) rows.push(at);
    for (const index of this.#near(line, from, to)) {
      const box = this.#boxes[index];
      if (!box) continue;
      for (let lane = 1; lane <= BESIDE; lane++) {
        const away = this.pace * (0.4 + 0.6 * lane);
        columns.push(box.x - away, box.x + box.width + away);
        rows.push(box.y - away, box.y + box.height + away);
      }
    }
    return { columns: byDetour(columns, from.x, to.x), rows: byDetour(rows, from.y, to.y) };
  }

  /** Indices of the boxes around and between the ends. */
  #near(line: RouteRequest, from: Point, to: Point): readonly number[] {
    const area = {
      x: Math.min(from.x, to.x) - this.pace,
      y: Math.min(from.y, to.y) - this.pace,
      width: Math.abs(from.x - to.x) + 2 * this.pace,
      height: Math.abs(from.y - to.y) + 2 * this.pace,
    };
    const found: number[] = [line.start.box, line.goal.box].filter((index) => index >= 0);
    this.#grid.each(area, (index) => {
      if (found.length < NEAR_BOXES && !found.includes(index)) found.push(index);
    });
    return found;
  }

  /** Index of the point before the longest piece without other lines beside it. */
  longestAlone(points: readonly Point[]): number {
    let [best, longest] = [0, -1];
    for (let index = 0; index + 1 < points.length; index++) {
      const [one, other] = [points[index], points[index + 1]];
      if (!one || !other) continue;
      const lying = one.y === other.y;
      const length = Math.abs(one.x - other.x) + Math.abs(one.y - other.y);
      const alone = length * (this.#isShared(one, other) ? 0.3 : lying ? 1 : 0.5);
      if (alone > longest) [best, longest] = [index, alone];
    }
    return best;
  }

  #isShared(one: Point, other: Point): boolean {
    if (this.#lying.length + this.#standing.length > MANY_LINES) return false;
    const lying = one.y === other.y;
    const at = lying ? one.y : one.x;
    const [from, to] = lying
      ? [Math.min(one.x, other.x), Math.max(one.x, other.x)]
      : [Math.min(one.y, other.y), Math.max(one.y, other.y)];
    return (lying ? this.#lying : this.#standing).some(
      (piece) => piece.at === at && piece.from < to && piece.to > from,
    );
  }
}

function boxOf(one: Point, other: Point): Box {
  const [x, y] = [Math.min(one.x, other.x), Math.min(one.y, other.y)];
  return { x, y, width: Math.abs(one.x - other.x), height: Math.abs(one.y - other.y) };
}

function piece(at: number, one: number, other: number, group: string): Piece {
  return { at, from: Math.min(one, other), to: Math.max(one, other), group };
}

/** Largest number of states that the typical size is computed from. */
const SAMPLE = 256;

/** Pace: a share of the median size of the states. */
export function paceOf(boxes: readonly Box[], frame: Size): number {
  const every = Math.ceil(boxes.length / SAMPLE);
  const sides = boxes
    .filter((_, index) => index % every === 0)
    .map(({ width, height }) => Math.min(width, height))
    .sort((one, other) => one - other);
  const usual = sides[sides.length >> 1] ?? Math.min(frame.width, frame.height) * 0.3;
  return Math.min(usual * 0.14, Math.min(frame.width, frame.height) * 0.03);
}

function byDetour(channels: readonly number[], from: number, to: number): readonly number[] {
  const detour = (at: number) => Math.abs(at - from) + Math.abs(at - to);
  return [...new Set(channels)].sort((one, other) => detour(one) - detour(other));
}

/** Number of reversals in a route. */
function turnsBack(points: readonly Point[]): number {
  let count = 0;
  for (let index = 1; index + 1 < points.length; index++) {
    const [before, at, after] = [points[index - 1], points[index], points[index + 1]];
    if (!before || !at || !after) continue;
    const along = (at.x - before.x) * (after.x - at.x) + (at.y - before.y) * (after.y - at.y);
    if (along < 0) count++;
  }
  return count;
}
