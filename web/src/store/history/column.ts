/** A growing list of numbers in a typed array with spare capacity. */

type TypedArray = Float64Array | Int32Array | Uint8Array;

const FIRST_ROOM = 1_024;

export class NumberColumn<A extends TypedArray> {
  readonly #make: new (
    length: number,
  ) => A;
  #values: A;
  #length = 0;

  constructor(make: new (length: number) => A) {
    this.#make = make;
    this.#values = new make(FIRST_ROOM);
  }

  get length(): number {
    return this.#length;
  }

  push(value: number): void {
    if (this.#length === this.#values.length) this.#grow();
    this.#values[this.#length] = value;
    this.#length += 1;
  }

  /** Replaces an existing number. */
  set(index: number, value: number): void {
    if (index < this.#length) this.#values[index] = value;
  }

  /** Returns 0 beyond the end. */
  at(index: number): number {
    return index < this.#length ? (this.#values[index] ?? 0) : 0;
  }

  /** For ascending numbers: index of the first that is not less than the value; the length if all are less. */
  firstFrom(value: number): number {
    return lowerBound(this.#length, (place) => this.at(place) < value);
  }

  #grow(): void {
    const wider = new this.#make(this.#values.length * 2);
    wider.set(this.#values);
    this.#values = wider;
  }
}

/** Binary search: the first place for which `isBefore` is false; `length` if it is true for all. */
export function lowerBound(length: number, isBefore: (place: number) => boolean): number {
  let [low, high] = [0, length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (isBefore(middle)) low = middle + 1;
    else high = middle;
  }
  return low;
}
