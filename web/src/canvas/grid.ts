/** Boxes by where they are: finds those in an area without a look at all of them. */

import { around, type Box } from "../model/geometry.ts";

/** Fewer are looked at one by one. */
const FEW = 48;
const PER_CELL = 4;
/** A box in more cells than these is looked at always. */
const WIDE = 64;

export class Grid {
  readonly #boxes: readonly Box[];
  readonly #cells: number[][] = [];
  readonly #wide: number[] = [];
  readonly #seen: Uint32Array;
  #round = 0;
  #bounds: Box = { x: 0, y: 0, width: 0, height: 0 };
  #side = 0;

  constructor(boxes: readonly Box[]) {
    this.#boxes = boxes;
    this.#seen = new Uint32Array(boxes.length);
    if (boxes.length > FEW) this.#fill();
  }

  /** Tells the index of every box that the area touches, in rising order. */
  each(area: Box, tell: (index: number) => void): void {
    if (this.#side === 0) {
      for (let index = 0; index < this.#boxes.length; index++) {
        if (this.#touches(index, area)) tell(index);
      }
      return;
    }
    for (const index of this.#near(area)) tell(index);
  }

  #near(area: Box): readonly number[] {
    this.#round++;
    const found = this.#wide.filter((index) => this.#touches(index, area));
    const [left, right] = this.#range(area.x, area.width, this.#bounds.x, this.#bounds.width);
    const [top, bottom] = this.#range(area.y, area.height, this.#bounds.y, this.#bounds.height);
    for (let row = top; row <= bottom; row++) {
      for (let column = left; column <= right; column++) {
        this.#gather(this.#cells[row * this.#side + column], area, found);
      }
    }
    return found.sort((one, other) => one - other);
  }

  /** What a cell has that no other cell had before. */
  #gather(cell: readonly number[] | undefined, area: Box, found: number[]): void {
    for (const index of cell ?? []) {
      if (this.#seen[index] === this.#round) continue;
      this.#seen[index] = this.#round;
      if (this.#touches(index, area)) found.push(index);
    }
  }

  #touches(index: number, area: Box): boolean {
    const box = this.#boxes[index];
    return box !== undefined && touches(box, area);
  }

  #fill(): void {
    this.#bounds = around(this.#boxes) ?? this.#bounds;
    this.#side = Math.max(1, Math.ceil(Math.sqrt(this.#boxes.length / PER_CELL)));
    this.#boxes.forEach((box, index) => {
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
  }

  /** The first and last cell of a stretch. */
  #range(at: number, length: number, start: number, whole: number): readonly [number, number] {
    const cell = (where: number) =>
      Math.min(
        this.#side - 1,
        Math.max(0, Math.floor(((where - start) / (whole || 1)) * this.#side)),
      );
    return [cell(at), cell(at + length)];
  }
}

/** Also boxes without a width or height, as straight lines have them. */
function touches(one: Box, other: Box): boolean {
  return (
    one.x <= other.x + other.width &&
    other.x <= one.x + one.width &&
    one.y <= other.y + other.height &&
    other.y <= one.y + one.height
  );
}
