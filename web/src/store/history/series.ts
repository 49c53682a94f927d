/** A value over the time of a run, in bounded memory. When there are too many points, each group of older ones is reduced to its
 * least and its greatest. */

import type { JsonValue } from "../../model/generated/protocol.ts";
import { read } from "../../model/wire.ts";
import { lowerBound } from "./column.ts";

/** Capacity of the points. */
export const POINTS_MAX = 4_000;
/** Capacity of changes to values that are not numbers. The newest are kept. */
const CHANGES_MAX = 100;
/** Size of the groups that are reduced to two points. */
const GROUP = 4;

export interface SeriesPoint {
  readonly sequence: number;
  readonly t_ns: number;
  readonly value: number;
}

export interface ChangeOfValue {
  readonly sequence: number;
  readonly t_ns: number;
  readonly value: JsonValue;
}

export class Series {
  #points: SeriesPoint[] = [];
  #changes: ChangeOfValue[] = [];
  #count = 0;
  /** Last value as a text if it was not a number. */
  #last: string | null = null;

  /** Numbers and booleans, the oldest first. */
  get points(): readonly SeriesPoint[] {
    return this.#points;
  }

  /** Changes to values of other types, the oldest first. */
  get changes(): readonly ChangeOfValue[] {
    return this.#changes;
  }

  /** Number of received values, including dropped ones. */
  get count(): number {
    return this.#count;
  }

  add(sequence: number, t_ns: number, value: JsonValue): void {
    this.#count += 1;
    const number = numberOf(value);
    if (number === null) {
      this.#addChange({ sequence, t_ns, value });
      return;
    }
    this.#last = null;
    this.#points.push({ sequence, t_ns, value: number });
    if (this.#points.length > POINTS_MAX) this.#points = thinned(this.#points);
  }

  #addChange(change: ChangeOfValue): void {
    const text = JSON.stringify(change.value);
    if (text === this.#last) return;
    this.#last = text;
    this.#changes.push(change);
    if (this.#changes.length > CHANGES_MAX) this.#changes.shift();
  }

  /** The last number up to an event; null before the first. */
  upTo(sequence: number): SeriesPoint | null {
    return this.#points[this.#indexAfter(sequence) - 1] ?? null;
  }

  /** Nearest number before or after an event. */
  beside(sequence: number, side: "before" | "after"): SeriesPoint | null {
    const index =
      side === "before" ? this.#indexAfter(sequence - 1) - 1 : this.#indexAfter(sequence);
    return this.#points[index] ?? null;
  }

  #indexAfter(sequence: number): number {
    return lowerBound(
      this.#points.length,
      (place) => (this.#points[place]?.sequence ?? 0) <= sequence,
    );
  }
}

/** Number to plot for a value; null if there is none. */
function numberOf(value: JsonValue): number | null {
  const found = read(value);
  if (found.kind === "number") return found.value;
  if (found.kind === "bool") return Number(found.value);
  return found.kind === "array" && found.shape.length === 0 ? (found.items?.[0] ?? null) : null;
}

/** Reduces each group in the older half to its extremes, in order. */
function thinned(points: readonly SeriesPoint[]): SeriesPoint[] {
  const half = points.length >> 1;
  const kept: SeriesPoint[] = [];
  for (let at = 0; at < half; at += GROUP) {
    const group = points.slice(at, Math.min(at + GROUP, half));
    const [least, greatest] = extremes(group);
    const [first, second] =
      least.sequence <= greatest.sequence ? [least, greatest] : [greatest, least];
    kept.push(first);
    if (second !== first) kept.push(second);
  }
  return [...kept, ...points.slice(half)];
}

function extremes(group: readonly SeriesPoint[]): readonly [SeriesPoint, SeriesPoint] {
  const [first, ...rest] = group;
  let [least, greatest] = [first, first];
  for (const point of rest) {
    if (!least || point.value < least.value) least = point;
    if (!greatest || point.value > greatest.value) greatest = point;
  }
  if (!least || !greatest) throw new Error("a group of no points has no extremes");
  return [least, greatest];
}
