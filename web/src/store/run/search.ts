/** Search in a run: in the page if all events are loaded, otherwise on the server, page by page from the start of the run. */

import { type ReadonlySignal, signal } from "@preact/signals-core";
import type { EventPage } from "../../model/generated/protocol.ts";
import { lowerBound } from "../history/column.ts";
import { Journal, type JournalEntry } from "../history/journal.ts";
import { HITS_MAX, JournalHits } from "../history/journal_hits.ts";
import type { Runs, Watch } from "../history/run.ts";
import { LatestRequest } from "../page/latest_request.ts";

type SearchedWatch = Pick<Watch, "id" | "journal" | "whenClosed">;

export class RunSearch {
  readonly #watch: SearchedWatch;
  readonly #wanted: string;
  readonly #nameOf: (path: string) => string;
  readonly #changed = signal(0);
  readonly #refusal = signal<string | null>(null);
  /** Results in the page; null once the server searches. */
  #here: JournalHits | null = null;
  /** Results from the server. */
  #there = new Journal();
  #next = 1;
  readonly #request: LatestRequest<number, EventPage>;

  constructor(
    watch: SearchedWatch,
    runs: Pick<Runs, "get">,
    wanted: string,
    nameOf: (path: string) => string,
  ) {
    this.#watch = watch;
    this.#wanted = wanted.trim();
    this.#nameOf = nameOf;
    const text = encodeURIComponent(this.#wanted);
    this.#request = new LatestRequest({
      ask: (from) => runs.get(watch.id, `hits?text=${text}&from=${from}`),
      take: (page) => this.#take(page),
      refused: ({ message }) => {
        this.#refusal.value = message;
        this.#changed.value += 1;
      },
    });
    this.follow();
  }

  /** Changes whenever the server has sent results, or its state changes. */
  get changed(): ReadonlySignal<number> {
    return this.#changed;
  }

  /** Reason why the server does not search. */
  get refusal(): string | null {
    return this.#refusal.value;
  }

  /** Number of results. */
  get count(): number {
    return this.#here ? this.#here.hits.length : this.#there.length;
  }

  /** True if the limit is reached; there may be more results. */
  get isFull(): boolean {
    return this.count >= HITS_MAX;
  }

  /** True while the server searches. */
  get isAsking(): boolean {
    return this.#here === null && this.#request.isPending;
  }

  /** Searches the new events of a growing run. */
  follow(): void {
    if (this.#wanted === "") return;
    const { journal } = this.#watch;
    if (journal.base === null) {
      if (this.#here?.journal !== journal) {
        this.#here = new JournalHits(journal, this.#wanted, this.#nameOf);
      }
      this.#here.follow();
      return;
    }
    this.#here = null;
    if (this.#next < journal.next && !this.isFull) this.#request.want(this.#next);
  }

  /** Ends the search. */
  end(): void {
    this.#request.close();
  }

  sequence(place: number): number {
    return this.#journal.sequence(this.#index(place));
  }

  t_ns(place: number): number {
    return this.#journal.t_ns(this.#index(place));
  }

  /** Event of a result; undefined if it was dropped. */
  at(place: number): JournalEntry | undefined {
    return this.#journal.at(this.#index(place));
  }

  /** Place of the first result after an event; of the first of all if there is none. */
  after(sequence: number): number {
    const place = lowerBound(this.count, (each) => this.sequence(each) <= sequence);
    return place < this.count ? place : 0;
  }

  /** Place of the last result before an event; of the last of all if there is none. */
  before(sequence: number): number {
    const place = lowerBound(this.count, (each) => this.sequence(each) < sequence);
    return place > 0 ? place - 1 : this.count - 1;
  }

  get #journal(): Journal {
    return this.#here?.journal ?? this.#there;
  }

  #index(place: number): number {
    return this.#here ? (this.#here.hits[place] ?? -1) : place;
  }

  #take(page: EventPage): void {
    this.#there.add(page.events, page.next);
    this.#next = page.next;
    this.#refusal.value = null;
    if (page.next <= page.last && !this.isFull) this.#request.want(page.next);
    this.#changed.value += 1;
  }
}
