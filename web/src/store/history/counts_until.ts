/** Counts and durations of states up to an event. Only the events between the last request and this one are processed. */

import { perOwner } from "../../model/per_owner.ts";
import { ENTERED, type Journal, LEFT } from "./journal.ts";
import { type CallLengths, lengthsOf } from "./lengths.ts";

/** Counts of one state, without steps back. */
export interface CountUntil {
  readonly path: string;
  readonly entries: number;
  readonly total_ns: number;
}

type CountUntilDraft = { -readonly [K in keyof CountUntil]: CountUntil[K] };

/** Counts before the event with this index. They are valid until the next call for the journal. */
export function countsUntil(journal: Journal, index: number): CountsUntil {
  const known = countsOf(journal);
  known.to(index);
  return known;
}

class CountsUntil {
  readonly #journal: Journal;
  readonly #lengths: CallLengths;
  /** By the number of the path. */
  readonly #all: (CountUntilDraft | undefined)[] = [];
  readonly #byPath = new Map<string, CountUntilDraft>();
  #at: number;

  constructor(journal: Journal) {
    this.#journal = journal;
    this.#lengths = lengthsOf(journal);
    this.#at = journal.first;
    for (const { path, entries, total_ns } of journal.base?.earlier?.states ?? []) {
      this.#byPath.set(path, { path, entries, total_ns });
    }
  }

  /** Moves to the position before the event with this index. */
  to(index: number): void {
    const until = Math.max(index, this.#journal.first);
    for (; this.#at < until; this.#at++) this.#add(this.#at, 1);
    for (; this.#at > until; this.#at--) this.#add(this.#at - 1, -1);
  }

  entries(path: string): number {
    return this.#byPath.get(path)?.entries ?? 0;
  }

  all(): Iterable<CountUntil> {
    return this.#byPath.values();
  }

  #add(index: number, by: number): void {
    const journal = this.#journal;
    const kind = journal.kind(index);
    if ((kind !== ENTERED && kind !== LEFT) || journal.isBack(index)) return;
    const count = this.#of(journal.pathNumber(index));
    if (kind === ENTERED) count.entries += by;
    else count.total_ns += by * this.#lengths.at(index);
  }

  #of(number: number): CountUntilDraft {
    let count = this.#all[number];
    if (!count) {
      const path = this.#journal.pathOf(number);
      count = this.#byPath.get(path) ?? { path, entries: 0, total_ns: 0 };
      this.#all[number] = count;
      this.#byPath.set(count.path, count);
    }
    return count;
  }
}

const countsOf = perOwner((journal: Journal) => new CountsUntil(journal));
