/** When each state was entered and left, by state: found without walking the journal again. Steps back are left out. */

import { perOwner } from "../../model/per_owner.ts";
import { lowerBound } from "./column.ts";
import { ENTERED, type Journal, LEFT } from "./journal.ts";
import type { Watch } from "./run.ts";

/** Indices of the journal, rising. */
interface StateVisits {
  readonly entered: number[];
  readonly left: number[];
}

export function visitsOf({ journal }: Pick<Watch, "journal">): Visits {
  return visitsIn(journal);
}

export class Visits {
  readonly #journal: Journal;
  readonly #states = new Map<string, StateVisits>();
  #next = 0;

  constructor(journal: Journal) {
    this.#journal = journal;
  }

  /** The number of the last event up to `until` by which the state was entered or left; null if there is none. */
  last(kind: "entered" | "left", path: string, until: number | null): number | null {
    const index = this.lastIndex(kind, path, until);
    return index === null ? null : this.#journal.sequence(index);
  }

  /** The same as an index of the journal. */
  lastIndex(kind: "entered" | "left", path: string, until: number | null): number | null {
    const all = this.#of(path)?.[kind] ?? [];
    return all[this.#countTo(all, until) - 1] ?? null;
  }

  /** How often it was entered up to a moment. */
  count(path: string, until: number | null): number {
    return this.#countTo(this.#of(path)?.entered ?? [], until);
  }

  /** The last number before the journal's next event: values that were written with an event are there by then. */
  untilNext(sequence: number): number {
    const next = this.#journal.indexOf(sequence + 1);
    return (next < this.#journal.length ? this.#journal.sequence(next) : this.#journal.next) - 1;
  }

  #of(path: string): StateVisits | undefined {
    this.#catchUp();
    return this.#states.get(path);
  }

  #countTo(all: readonly number[], until: number | null): number {
    if (until === null) return all.length;
    return lowerBound(all.length, (place) => this.#journal.sequence(all[place] ?? 0) <= until);
  }

  #catchUp(): void {
    const journal = this.#journal;
    for (; this.#next < journal.length; this.#next += 1) {
      const kind = journal.kind(this.#next);
      if ((kind !== ENTERED && kind !== LEFT) || journal.isBack(this.#next)) continue;
      const path = journal.pathOf(journal.pathNumber(this.#next));
      const state = this.#states.get(path) ?? { entered: [], left: [] };
      this.#states.set(path, state);
      (kind === ENTERED ? state.entered : state.left).push(this.#next);
    }
  }
}

const visitsIn = perOwner((journal: Journal) => new Visits(journal));
