/** Boxes of the states of a container, including those without a position in the file. They are placed in rows as in the reference,
 * without overlaps if possible. */

import type { StateDocument } from "./generated/protocol.ts";
import { type Box, intersects, type Size } from "./geometry.ts";
import { defaultChildBox, readLayout } from "./layout_reader.ts";

/** A state of the machine; undefined after its removal. */
type Child = StateDocument | undefined;

/** Factor by which the places shrink if there are too few. */
const SMALLER = 0.85;
/** Greatest number of attempts with ever smaller places. */
const ATTEMPTS_MAX = 40;

/** Boxes of all children, in their order. */
export function childBoxesOf(children: readonly Child[], container: Size): readonly Box[] {
  const known = children.map((child) => (child ? boxOf(child, container) : null));
  const drawn = known.filter((box) => box !== null);
  const missing = known.length - drawn.length;
  if (missing === 0) return drawn;
  for (let attempt = 0; attempt < ATTEMPTS_MAX; attempt++) {
    const places = new Places(container, SMALLER ** attempt, drawn);
    const found = places.count < missing ? null : placed(known, children, places);
    if (found) return found;
  }
  return known.map((box, index) => box ?? defaultChildBox(index, container));
}

function boxOf(child: StateDocument, container: Size): Box | null {
  const { position, size } = readLayout(child);
  if (!position) return null;
  const side = sideIn(container);
  return { ...position, ...(size ?? { width: side, height: side }) };
}

function placed(
  known: readonly (Box | null)[],
  children: readonly Child[],
  places: Places,
): readonly Box[] | null {
  const boxes: Box[] = [];
  for (const [index, box] of known.entries()) {
    const place = box ?? places.take(index);
    if (!place) return null;
    const child = children[index];
    const own = child && readLayout(child).size;
    boxes.push(own && !box ? { ...place, ...own } : place);
  }
  return boxes;
}

function sideIn({ width, height }: Size): number {
  return Math.min(width, height) * 0.2;
}

/** Equal squares in rows, with a record of the taken ones. */
class Places {
  readonly count: number;
  readonly #columns: number;
  readonly #side: number;
  readonly #drawn: readonly Box[];
  readonly #taken = new Set<number>();
  #next = 0;

  constructor(container: Size, part: number, drawn: readonly Box[]) {
    this.#side = sideIn(container) * part;
    this.#drawn = drawn;
    const { pitch } = this;
    this.#columns = Math.max(1, Math.floor((container.width - this.#side * 0.4) / pitch));
    const rows = Math.max(1, Math.floor((container.height - this.#side * 0.8) / pitch));
    this.count = this.#columns * rows;
  }

  get pitch(): number {
    return this.#side * 1.2;
  }

  /** The place with this number if it is free, otherwise the first free one; null if all are taken. */
  take(wanted: number): Box | null {
    if (this.#isFree(wanted)) return this.#put(wanted);
    while (this.#next < this.count && !this.#isFree(this.#next)) this.#next++;
    return this.#next < this.count ? this.#put(this.#next) : null;
  }

  #put(place: number): Box {
    this.#taken.add(place);
    return this.#box(place);
  }

  #isFree(place: number): boolean {
    if (place >= this.count || this.#taken.has(place)) return false;
    const box = this.#box(place);
    return !this.#drawn.some((other) => intersects(box, other));
  }

  #box(place: number): Box {
    const { pitch } = this;
    return {
      x: this.#side * 0.2 + (place % this.#columns) * pitch,
      y: this.#side * 0.6 + Math.floor(place / this.#columns) * pitch,
      width: this.#side,
      height: this.#side,
    };
  }
}
