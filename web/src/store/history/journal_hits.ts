/** Results of a search in a run: entries by the names of their states, ends by their outcomes, log lines by their text. The search
 * continues as the journal grows. */

import { ENTERED, type Journal, LEFT } from "./journal.ts";

/** Greatest number of results. */
export const HITS_MAX = 20_000;

export class JournalHits {
  /** Indices in the journal. */
  readonly hits: number[] = [];
  readonly journal: Journal;
  readonly #wanted: string;
  readonly #name: (path: string) => string;
  /** True for states whose name matches, by the number of the path. */
  readonly #named: boolean[] = [];
  #read = 0;

  constructor(journal: Journal, wanted: string, name: (path: string) => string) {
    this.journal = journal;
    this.#wanted = wanted.trim().toLowerCase();
    this.#name = name;
  }

  /** True if the limit is reached; there may be more results. */
  get isFull(): boolean {
    return this.hits.length >= HITS_MAX;
  }

  follow(): void {
    if (this.#wanted === "") return;
    for (; this.#read < this.journal.length && !this.isFull; this.#read++) {
      if (this.#is(this.#read)) this.hits.push(this.#read);
    }
  }

  #is(index: number): boolean {
    const journal = this.journal;
    switch (journal.kind(index)) {
      case ENTERED:
        return this.#isNamed(journal.pathNumber(index));
      case LEFT:
        return this.#has(journal.outcome(index)?.name ?? "");
      default: {
        const event = journal.other(index);
        return event?.type === "log" && this.#has(event.message);
      }
    }
  }

  #isNamed(path: number): boolean {
    let is = this.#named[path];
    if (is === undefined) {
      is = this.#has(this.#name(this.journal.pathOf(path)));
      this.#named[path] = is;
    }
    return is;
  }

  #has(text: string): boolean {
    return text.toLowerCase().includes(this.#wanted);
  }
}
