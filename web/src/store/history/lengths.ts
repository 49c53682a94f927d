/** Duration of each call, by the index of its end in the journal. Each event is read once. */

import { perOwner } from "../../model/per_owner.ts";
import { NumberColumn } from "./column.ts";
import { ENTERED, type Journal, LEFT } from "./journal.ts";

export class CallLengths {
  readonly #journal: Journal;
  /** 0 for events that are not ends. */
  readonly #lengths = new NumberColumn(Float64Array);
  /** Time of each state's last entry, by the number of its path. */
  readonly #entered: number[] = [];

  constructor(journal: Journal) {
    this.#journal = journal;
  }

  /** In ns. */
  at(index: number): number {
    while (this.#lengths.length <= index && this.#lengths.length < this.#journal.length)
      this.#read(this.#lengths.length);
    return this.#lengths.at(index);
  }

  #read(index: number): void {
    const kind = this.#journal.kind(index);
    const number = this.#journal.pathNumber(index);
    const t_ns = this.#journal.t_ns(index);
    if (kind === ENTERED) this.#entered[number] = t_ns;
    const isWhole = kind === LEFT && index >= this.#journal.first;
    this.#lengths.push(isWhole ? t_ns - (this.#entered[number] ?? 0) : 0);
  }
}

export const lengthsOf = perOwner((journal: Journal) => new CallLengths(journal));
