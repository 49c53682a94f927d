/** Spatial index of boxes: finds the boxes in an area without a scan of all. */

import { type Box, boundsOf } from "../../model/geometry.ts";

/** Up to this many boxes are scanned one by one. */
const FEW = 48;
const PER_CELL = 4;
/** A box in more cells than this is checked on every query. */
const WIDE = 64;

/** Number of moved boxes after which a grid is filled anew. */
const LOOSE = 96;

export class Grid {
  readonly boxes: readonly Box[];
  #cells: number[][] = [];
  /** Boxes that every query checks: those in many cells, and those that moved after the cells were filled. */
  #wide: number[] = [];
  /** Length of `#wide` when the cells were filled. */
  #fixed = 0;
  readonly #seen: Uint32Array;
  #round = 0;
  #bounds: Box = { x: 0, y: 0, width: 0, height: 0 };
  #side = 0;

  /** `before` is a previous grid. Its cells are reused if most boxes are unchanged: identical objects at identical indices. */
  constructor(boxes: readonly Box[], before: Grid | null = null) {
    this.boxes = boxes;
    this.#seen = new Uint32Array(boxes.length > FEW ? boxes.length : 0);
    if (boxes.length > FEW && !this.#takeOver(before)) this.#fill();
  }

  #takeOver(before: Grid | null): boolean {
    if (!before || before.#side === 0 || before.boxes.length !== this.boxes.length) return false;
    const loose = new Set(before.#wide);
    const most = before.#fixed + LOOSE;
    for (let index = 0; index < this.boxes.length; index++) {
      if (this.boxes[index] === before.boxes[index]) continue;
      if (loose.add(index).size > most) return false;
    }
    [this.#cells, this.#bounds, this.#side] = [before.#cells, before.#bounds, before.#side];
    this.#wide = [...loose];
    this.#fixed = before.#fixed;
    return true;
  }

  /** Calls back with the index of every box that touches the area, in rising order. */
  each(area: Box, tell: (index: number) => void): void {
    if (this.#side === 0) {
      for (let index = 0; index < this.boxes.length; index++) {
        if (this.#touches(index, area)) tell(index);
      }
      return;
    }
    for (const index of this.#near(area)) tell(index);
  }

  #near(area: Box): readonly number[] {
    this.#round++;
    const found: number[] = [];
    this.#gather(this.#wide, area, found);
    const [left, right] = this.#range(area.x, area.width, this.#bounds.x, this.#bounds.width);
    const [top, bottom] = this.#range(area.y, area.height, this.#bounds.y, this.#bounds.height);
    for (let row = top; row <= bottom; row++) {
      for (let column = left; column <= right; column++) {
        this.#gather(this.#cells[row * this.#side + column], area, found);
      }
    }
    return found.sort((one, other) => one - other);
  }

  /** Adds the boxes of a cell that were not found in an earlier cell. */
  #gather(cell: readonly number[] | undefined, area: Box, found: number[]): void {
    for (const index of cell ?? []) {
      if (this.#seen[index] === this.#round) continue;
      this.#seen[index] = this.#round;
      if (this.#touches(index, area)) found.push(index);
    }
  }

  #touches(index: number, area: Box): boolean {
    const box = this.boxes[index];
    return box !== undefined && touches(box, area);
  }

  #fill(): void {
    this.#bounds = boundsOf(this.boxes) ?? this.#bounds;
    this.#side = Math.max(1, Math.ceil(Math.sqrt(this.boxes.length / PER_CELL)));
    this.boxes.forEach((box, index) => {
      const [left, right] = this.#range(box.x, box.width, this.#bounds.x, this.#bounds.width);
      const [top, bottom] = this.#range(box.y, box.height, this.#bounds.y, this.#bounds.height);
      if ((right - left + 1) * (bottom - top + 1) > WIDE) {
        this.#wide.push(index);
        return;
      }
      for (let row = top; row <= bottom; row++) {
        for (let column = left; column <= right; column++) {
          const cell = row * this.#side + column;
          const there = this.#cells[cell];
          if (there) there.push(index);
          else this.#cells[cell] = [index];
        }
      }
    });
    this.#fixed = this.#wide.length;
  }

  /** First and last cell of a range of coordinates. */
  #range(at: number, length: number, start: number, whole: number): readonly [number, number] {
    const cell = (where: number) =>
      Math.min(
        this.#side - 1,
        Math.max(0, Math.floor(((where - start) / (whole || 1)) * this.#side)),
      );
    return [cell(at), cell(at + length)];
  }
}

/** Also true for boxes without a width or height, such as straight lines. */
export function touches(one: Box, other: Box): boolean {
  return (
    one.x <= other.x + other.width &&
    other.x <= one.x + one.width &&
    one.y <= other.y + other.height &&
    other.y <= one.y + one.height
  );
}

export function same(one: Box, other: Box): boolean {
  return (
    one.x === other.x &&
    one.y === other.y &&
    one.width === other.width &&
    one.height === other.height
  );
}
