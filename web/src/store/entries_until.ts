/** How often states had been entered until an event: walks only the way from the event that was asked for last. */

import { ENTERED, type Journal } from "./journal.ts";

export class EntriesUntil {
  readonly #counts = new Map<number, number>();
  readonly #numbers = new Map<string, number>();
  #at = 0;

  /** Goes to the place before the event with this index. */
  to(journal: Journal, index: number): void {
    for (; this.#at < index; this.#at++) this.#add(journal, this.#at, 1);
    for (; this.#at > index; this.#at--) this.#add(journal, this.#at - 1, -1);
  }

  of(path: string): number {
    return this.#counts.get(this.#numbers.get(path) ?? -1) ?? 0;
  }

  #add(journal: Journal, index: number, by: number): void {
    if (journal.kind(index) !== ENTERED || journal.isBack(index)) return;
    const number = journal.pathNumber(index);
    const before = this.#counts.get(number);
    if (before === undefined) this.#numbers.set(journal.pathOf(number), number);
    this.#counts.set(number, (before ?? 0) + by);
  }
}
