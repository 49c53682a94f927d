/** Parts of a run's history that are not the newest: each asked for when a moment in it is shown, the last few kept. */

import type { EarlierHistory, HistoryEntry, Window } from "../model/generated/protocol.ts";
import { Journal } from "../store/history/journal.ts";
import { LatestRequest } from "../store/page/latest_request.ts";
import { RefusalError } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";

interface PastWindowsPorts {
  readonly clock: Clock;
  /** Asks below the run. */
  readonly ask: <T>(what: string) => Promise<T>;
  /** One has come, or knows more than before. */
  readonly changed: () => void;
}

/** Number of requested events, half of them before the moment. */
const EVENTS = 10_000;
/** Capacity of the parts. */
const KEPT_MAX = 4;

export class PastWindows {
  readonly #ports: PastWindowsPorts;
  #wanted: number | null = null;
  /** The one that was shown last is at the end. */
  #all: readonly Journal[] = [];
  readonly #request: LatestRequest<number, Window>;

  constructor(ports: PastWindowsPorts) {
    this.#ports = ports;
    this.#request = new LatestRequest({
      ask: (sequence) => {
        const from = Math.max(1, sequence - EVENTS / 2);
        return ports.ask(`window?from=${from}&count=${EVENTS}`);
      },
      take: (window) => void this.#take(window),
      takeEarlier: (window) => {
        // It may have the newest moment, too.
        const journal = this.#take(window);
        if (this.#wanted !== null && journal.covers(this.#wanted)) this.#request.drop();
      },
      after: ports.clock.after,
    });
  }

  /** The one that was shown last; null if there is none. */
  get last(): Journal | null {
    return this.#all.at(-1) ?? null;
  }

  /** The part with a moment; null if it is not here. */
  at(sequence: number): Journal | null {
    return this.#all.findLast((journal) => journal.covers(sequence)) ?? null;
  }

  /** Stores a part that was received by other means. */
  keep(journal: Journal): void {
    this.#all = [...this.#all.filter((each) => each !== journal), journal].slice(-KEPT_MAX);
  }

  /** Asks for the part with a moment unless it is here; null: for none any more. */
  want(sequence: number | null): void {
    this.#wanted = sequence;
    const known = sequence === null ? null : this.at(sequence);
    if (known) this.keep(known);
    if (sequence === null || known) this.#request.drop();
    else this.#request.want(sequence);
  }

  close(): void {
    this.#request.close();
    this.#all = [];
  }

  #take(window: Window): Journal {
    const journal = journalOf(window, null);
    this.keep(journal);
    this.#ports.changed();
    if (window.before.sequence > 0) void this.#learn(journal, window);
    return journal;
  }

  /** The state before the part arrives later, because the server may have to read a long run. */
  async #learn(journal: Journal, window: Window): Promise<void> {
    try {
      const earlier = await this.#ports.ask<EarlierHistory>(`earlier/${window.before.sequence}`);
      if (!this.#all.includes(journal)) return;
      const whole = journalOf(window, earlier);
      this.#all = this.#all.map((each) => (each === journal ? whole : each));
      this.#ports.changed();
    } catch (error) {
      if (!(error instanceof RefusalError)) throw error;
    }
  }
}

function journalOf({ before, events, next }: Window, earlier: EarlierHistory | null): Journal {
  const journal = new Journal(before.sequence === 0 ? null : { before, earlier });
  journal.add(events satisfies readonly HistoryEntry[], next);
  return journal;
}
