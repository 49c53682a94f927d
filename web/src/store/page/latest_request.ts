/** One request at a time, always for the newest wish, repeated until it is answered or refused for good. Knows neither the server nor
 * what is requested. */

import { RefusalError } from "./server.ts";

/** Calls a function later; the returned function cancels that. */
type After = (wait_ms: number, call: () => void) => () => void;

export interface LatestRequestPorts<Wish, Answer> {
  readonly ask: (wish: Wish) => Promise<Answer>;
  /** Receives the answer to the newest wish. */
  readonly take: (answer: Answer, wish: Wish) => void;
  /** Receives the answer to an earlier wish. Without it, such answers are dropped. */
  readonly takeEarlier?: (answer: Answer, wish: Wish) => void;
  /** Receives each refusal of the newest wish. */
  readonly refused?: (error: RefusalError, wish: Wish) => void;
  /** True if a refused request is repeated. Without it, refusals for now are. */
  readonly isRepeated?: (error: RefusalError) => boolean;
  /** Interval between a refusal and the next request, in ms. */
  readonly again_ms?: number;
  readonly after?: After;
}

const AGAIN_MS = 1_000;

export class LatestRequest<Wish, Answer> {
  readonly #ports: LatestRequestPorts<Wish, Answer>;
  /** Null without a pending wish. */
  #pending: { readonly wish: Wish } | null = null;
  #isAsking = false;
  #isClosed = false;
  /** Cancels the wait after a refusal; null while there is none. */
  #cancel: (() => void) | null = null;

  constructor(ports: LatestRequestPorts<Wish, Answer>) {
    this.#ports = ports;
  }

  /** True until the newest wish is answered, refused for good, or dropped. */
  get isPending(): boolean {
    return this.#pending !== null;
  }

  /** Requests this instead of any earlier wish. A wish that equals the pending one changes nothing. After a refusal the next request
   * waits for the interval, whatever it is for. */
  want(wish: Wish): void {
    if (this.#isClosed || this.#pending?.wish === wish) return;
    this.#pending = { wish };
    void this.#run();
  }

  /** Drops the pending wish. */
  drop(): void {
    this.#pending = null;
  }

  /** Drops all wishes for good. */
  close(): void {
    this.#isClosed = true;
    this.#pending = null;
    this.#cancel?.();
    this.#cancel = null;
  }

  async #run(): Promise<void> {
    if (this.#isAsking || this.#cancel) return;
    this.#isAsking = true;
    try {
      while (this.#pending && !this.#cancel) await this.#ask(this.#pending);
    } finally {
      this.#isAsking = false;
    }
  }

  async #ask(pending: { readonly wish: Wish }): Promise<void> {
    const { ask, take, takeEarlier } = this.#ports;
    const { wish } = pending;
    try {
      const answer = await ask(wish);
      if (this.#isClosed) return;
      if (this.#pending?.wish !== wish) return takeEarlier?.(answer, wish);
      this.#pending = null;
      take(answer, wish);
    } catch (error) {
      if (!(error instanceof RefusalError)) {
        if (this.#pending?.wish === wish) this.#pending = null;
        throw error;
      }
      if (this.#pending?.wish === wish) this.#refuse(error, wish);
    }
  }

  #refuse(error: RefusalError, wish: Wish): void {
    const { refused, isRepeated = ({ isForNow }) => isForNow } = this.#ports;
    const { after = later, again_ms = AGAIN_MS } = this.#ports;
    if (!isRepeated(error)) this.#pending = null;
    this.#cancel = after(again_ms, () => {
      this.#cancel = null;
      void this.#run();
    });
    refused?.(error, wish);
  }
}

function later(wait_ms: number, call: () => void): () => void {
  const timer = setTimeout(call, wait_ms);
  return () => clearTimeout(timer);
}
