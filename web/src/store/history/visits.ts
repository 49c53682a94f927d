/** Entries and ends of each state, indexed so that the journal is read once. Steps back are ignored. */

import type { EarlierState, Outcome } from "../../model/generated/protocol.ts";
import { perOwner } from "../../model/per_owner.ts";
import { lowerBound } from "./column.ts";
import { ENTERED, type Journal, LEFT } from "./journal.ts";
import type { Watch } from "./run.ts";

/** Indices in the journal, ascending. */
interface StateVisits {
  readonly entered: number[];
  readonly left: number[];
}

/** A state's entry or end. */
export interface Visit {
  readonly sequence: number;
  readonly t_ns: number;
  /** Outcome of an end; null for an entry. */
  readonly outcome: Outcome | null;
}

/** Visits around the shown moment, and the last ones before them. */
export function visitsOf({ window }: Pick<Watch, "window">): Visits {
  return visitsIn(window);
}

export class Visits {
  readonly #journal: Journal;
  readonly #states = new Map<string, StateVisits>();
  readonly #earlier: ReadonlyMap<string, EarlierState>;
  #next = 0;

  constructor(journal: Journal) {
    this.#journal = journal;
    const states = journal.base?.earlier?.states ?? [];
    this.#earlier = new Map(states.map((state) => [state.path, state]));
  }

  /** Sequence number of the last entry or end up to `until`; null if there is none. */
  last(kind: "entered" | "left", path: string, until: number | null): number | null {
    return this.lastVisit(kind, path, until)?.sequence ?? null;
  }

  /** Last entry or end up to `until`, with its time and outcome. */
  lastVisit(kind: "entered" | "left", path: string, until: number | null): Visit | null {
    const index = this.lastIndex(kind, path, until);
    if (index === null) return this.#lastEarlier(kind, path, until);
    return {
      sequence: this.#journal.sequence(index),
      t_ns: this.#journal.t_ns(index),
      outcome: this.#journal.outcome(index),
    };
  }

  #lastEarlier(kind: "entered" | "left", path: string, until: number | null): Visit | null {
    const state = this.#earlier.get(path);
    const turn = kind === "entered" ? state?.entered : state?.left;
    if (!turn || (until !== null && turn.sequence > until)) return null;
    return { outcome: null, ...turn };
  }

  /** Index in the journal of the last entry or end up to `until`. */
  lastIndex(kind: "entered" | "left", path: string, until: number | null): number | null {
    const all = this.#of(path)?.[kind] ?? [];
    return all[this.#countTo(all, until) - 1] ?? null;
  }

  /** Number of entries up to a moment. */
  count(path: string, until: number | null): number {
    const all = this.#of(path)?.entered ?? [];
    const known = this.#earlier.get(path);
    if (!known) return this.#countTo(all, until);
    const { first } = this.#journal;
    return (
      known.entries +
      this.#countTo(
        all.filter((index) => index >= first),
        until,
      )
    );
  }

  /** Last sequence number before the journal's next event. Values written with an event exist by then. */
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
      // Only some earlier ends are in the journal; the last ones come from its base.
      if (kind === LEFT && this.#next < journal.first) continue;
      const path = journal.pathOf(journal.pathNumber(this.#next));
      const state = this.#states.get(path) ?? { entered: [], left: [] };
      this.#states.set(path, state);
      (kind === ENTERED ? state.entered : state.left).push(this.#next);
    }
  }
}

const visitsIn = perOwner((journal: Journal) => new Visits(journal));
