/** Counts and durations of states, updated as events of a run arrive. */

import type { EarlierState, Outcome } from "../../model/generated/protocol.ts";

export interface Count {
  readonly path: string;
  /** Number of entries, without steps back. */
  readonly entries: number;
  /** Number of ends, and their durations: total, least and greatest. */
  readonly ends: number;
  readonly total_ns: number;
  readonly min_ns: number;
  readonly max_ns: number;
  /** Durations of the last ends, at most `LENGTHS_MAX`, unordered. */
  readonly lengths_ns: readonly number[];
  /** Time of the last entry. */
  readonly entered_ns: number;
  /** Time of the last end; null before the first. */
  readonly left_ns: number | null;
  readonly last: Outcome | null;
}

/** Number of recent ends whose duration is kept: enough for a median. */
export const LENGTHS_MAX = 31;

type CountDraft = { -readonly [K in keyof Count]: Count[K] } & { readonly lengths_ns: number[] };

export class Counts {
  readonly #all = new Map<number, CountDraft>();
  readonly #byPath = new Map<string, CountDraft>();

  get(path: string): Count | undefined {
    return this.#byPath.get(path);
  }

  all(): Iterable<Count> {
    return this.#all.values();
  }

  /** Sets the counts of a state before the first event. */
  begin(number: number, state: EarlierState): void {
    const { path, entries, ends, total_ns, max_ns, entered, left } = state;
    const count = this.#of(number, path);
    Object.assign(count, { entries, ends, total_ns, max_ns });
    if (ends > 0) count.min_ns = state.min_ns;
    count.entered_ns = entered?.t_ns ?? 0;
    count.left_ns = left?.t_ns ?? null;
    count.last = left?.outcome ?? null;
  }

  /** Sets the entry time of a state that was active before the first event. */
  active(number: number, path: string, t_ns: number): void {
    this.#of(number, path).entered_ns = t_ns;
  }

  entered(number: number, path: string, t_ns: number, isBack: boolean): void {
    const count = this.#of(number, path);
    if (!isBack) count.entries += 1;
    count.entered_ns = t_ns;
  }

  left(number: number, path: string, t_ns: number, outcome: Outcome, isBack: boolean): void {
    const count = this.#of(number, path);
    count.left_ns = t_ns;
    if (isBack) return;
    const length = t_ns - count.entered_ns;
    count.last = outcome;
    if (count.lengths_ns.length < LENGTHS_MAX) count.lengths_ns.push(length);
    else count.lengths_ns[count.ends % LENGTHS_MAX] = length;
    count.ends += 1;
    count.total_ns += length;
    count.min_ns = Math.min(count.min_ns, length);
    count.max_ns = Math.max(count.max_ns, length);
  }

  #of(number: number, path: string): CountDraft {
    let count = this.#all.get(number);
    if (!count) {
      count = {
        path,
        entries: 0,
        ends: 0,
        total_ns: 0,
        min_ns: Number.POSITIVE_INFINITY,
        max_ns: 0,
        lengths_ns: [],
        entered_ns: 0,
        left_ns: null,
        last: null,
      };
      this.#all.set(number, count);
      this.#byPath.set(path, count);
    }
    return count;
  }
}
