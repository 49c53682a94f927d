/** Calls inside a call, with repetitions folded into loops: `A B C B C B C` is A, then B C three times. Calls are processed one by
 * one as they arrive, so that equal calls always give equal folds. */

/** A single call, or a loop of consecutive calls. */
export type Fold =
  | { readonly kind: "call"; readonly call: number }
  | {
      readonly kind: "loop";
      /** All calls, round after round; the last round may be incomplete. */
      readonly calls: readonly number[];
      /** Number of calls per round. */
      readonly period: number;
    };

/** Greatest length of a round. */
const LONGEST = 24;

interface Loop {
  readonly kind: "loop";
  readonly calls: number[];
  readonly period: number;
}

export class Folds {
  readonly #all: (Fold | Loop)[] = [];
  readonly #pathOf: (call: number) => number;
  #taken = 0;

  constructor(pathOf: (call: number) => number) {
    this.#pathOf = pathOf;
  }

  get all(): readonly Fold[] {
    return this.#all;
  }

  /** Processes the new calls of a growing list. */
  follow(calls: readonly number[]): void {
    for (; this.#taken < calls.length; this.#taken++) this.#take(calls[this.#taken] ?? 0);
  }

  #take(call: number): void {
    const last = this.#all.at(-1);
    if (last?.kind === "loop") {
      const { calls, period } = last as Loop;
      if (this.#isSame(calls[calls.length - period], call)) {
        calls.push(call);
        return;
      }
      this.#breakOff(last as Loop);
    }
    this.#all.push({ kind: "call", call });
    this.#findLoop();
  }

  /** Removes an incomplete round from the loop. */
  #breakOff({ calls, period }: Loop): void {
    const rest = calls.splice(calls.length - (calls.length % period));
    for (const call of rest) this.#all.push({ kind: "call", call });
  }

  /** Folds the last calls into a loop if they consist of two equal rounds. */
  #findLoop(): void {
    const last = this.#callAt(1);
    for (let period = 1; period <= LONGEST; period++) {
      if (last === null || !this.#isSame(this.#callAt(1 + period) ?? undefined, last)) continue;
      const calls = this.#last(2 * period);
      if (!calls) return;
      if (!calls.slice(period).every((call, at) => this.#isSame(calls[at], call))) continue;
      this.#all.splice(-2 * period);
      this.#all.push({ kind: "loop", calls: [...calls], period });
      return;
    }
  }

  /** The call at this place from the end; null inside a loop. */
  #callAt(place: number): number | null {
    const fold = this.#all.at(-place);
    return fold?.kind === "call" ? fold.call : null;
  }

  /** The last calls; null if some of them are inside a loop. */
  #last(many: number): readonly number[] | null {
    if (this.#all.length < many) return null;
    const calls: number[] = [];
    for (const fold of this.#all.slice(-many)) {
      if (fold.kind === "loop") return null;
      calls.push(fold.call);
    }
    return calls;
  }

  #isSame(one: number | undefined, other: number): boolean {
    return one !== undefined && this.#pathOf(one) === this.#pathOf(other);
  }
}
