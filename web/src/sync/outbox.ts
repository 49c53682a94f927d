/** Requests of this page with an unknown fate: sent in their order, repeated under their id until an answer arrives, and settled once. The
 * transport chooses the timeout by the measured delay. Knows ids and answers, not the content. */

import { RefusalError } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";

/** Not settled: it is sent again in a moment. */
export const AGAIN = Symbol("again");
/** Not settled: it is sent again after some seconds. */
export const LATER = Symbol("later");
/** Not settled, but answered: it is not sent again by itself. */
export const HELD = Symbol("held");

export interface OutboxPorts<T, R, F> {
  readonly clock: Clock;
  /** Sends it; fails with a [`RefusalError`]. Null: its answer comes by `answered` or `refused`, and it is sent again by
   * `connected`. */
  readonly send: (item: T) => Promise<R> | null;
  /** Result of an answer. */
  readonly onAnswer: (item: T, answer: R) => F | typeof HELD | typeof LATER;
  /** Result of a refusal. Its errors are passed to the caller. */
  readonly onRefusal: (item: T, error: RefusalError) => F | typeof HELD | typeof AGAIN;
  /** True if requests can be sent; always by default. */
  readonly isUp?: () => boolean;
  /** True if it is sent after the answers of all earlier requests, and before all later ones. */
  readonly isAlone?: (item: T) => boolean;
}

interface Entry<T, F> {
  readonly item: T;
  /** `sent` without a promise, `asked` with one; `paused` until it is sent again. */
  state: "waiting" | "sent" | "asked" | "paused" | "held";
  readonly settle: (fate: F) => void;
  readonly fail: (error: unknown) => void;
}

const AGAIN_MS = 500;
const LATER_MS = 5_000;

export class Outbox<T extends { readonly id: string }, R, F> {
  readonly #ports: OutboxPorts<T, R, F>;
  readonly #entries = new Map<string, Entry<T, F>>();
  #items: readonly T[] = [];

  constructor(ports: OutboxPorts<T, R, F>) {
    this.#ports = ports;
  }

  /** Unsettled requests, the oldest first. */
  get items(): readonly T[] {
    return this.#items;
  }

  has(id: string): boolean {
    return this.#entries.has(id);
  }

  /** Sends it until its fate is known. */
  put(item: T): Promise<F> {
    return new Promise((settle, fail) => {
      this.#entries.set(item.id, { item, state: "waiting", settle, fail });
      this.#items = [...this.#items, item];
      this.#pump();
    });
  }

  /** Settles a request whose fate is known from any source. Settled requests do not change. */
  settle(id: string, fate: F): void {
    this.#take(id)?.settle(fate);
    this.#pump();
  }

  answered(id: string, answer: R): void {
    this.#end(id, (item) => this.#ports.onAnswer(item, answer));
  }

  refused(id: string, error: RefusalError): void {
    this.#end(id, (item) => this.#ports.onRefusal(item, error));
  }

  /** Held requests are sent, too. */
  again(id: string): void {
    const entry = this.#entries.get(id);
    if (entry?.state === "held") entry.state = "waiting";
    this.#pump();
  }

  /** There is a connection, perhaps another one: what was sent may be lost. */
  connected(): void {
    for (const entry of this.#entries.values()) if (entry.state === "sent") entry.state = "waiting";
    this.#pump();
  }

  #end(id: string, fateOf: (item: T) => F | typeof HELD | typeof AGAIN | typeof LATER): void {
    const entry = this.#entries.get(id);
    if (!entry || entry.state === "held") return;
    entry.state = "held";
    try {
      const fate = fateOf(entry.item);
      if (fate === AGAIN) this.#after(AGAIN_MS, entry);
      else if (fate === LATER) this.#after(LATER_MS, entry);
      else if (fate !== HELD) this.settle(id, fate);
    } catch (error) {
      this.#take(id)?.fail(error);
    }
    this.#pump();
  }

  #after(pause_ms: number, entry: Entry<T, F>): void {
    entry.state = "paused";
    this.#ports.clock.after(pause_ms, () => {
      if (entry.state === "paused") entry.state = "waiting";
      this.#pump();
    });
  }

  #take(id: string): Entry<T, F> | undefined {
    const entry = this.#entries.get(id);
    if (this.#entries.delete(id)) this.#items = this.#items.filter((item) => item.id !== id);
    return entry;
  }

  #pump(): void {
    const { isUp, isAlone } = this.#ports;
    if (isUp?.() === false) return;
    let isFirst = true;
    for (const entry of this.#entries.values()) {
      if (entry.state === "held") continue;
      const waits = isAlone?.(entry.item) === true;
      if (entry.state === "waiting" && (isFirst || !waits)) this.#send(entry);
      if (waits) return;
      isFirst = false;
    }
  }

  #send(entry: Entry<T, F>): void {
    entry.state = "sent";
    const answer = this.#ports.send(entry.item);
    if (answer) void this.#ask(entry, answer);
  }

  async #ask(entry: Entry<T, F>, answer: Promise<R>): Promise<void> {
    const { id } = entry.item;
    entry.state = "asked";
    try {
      this.answered(id, await answer);
    } catch (error) {
      if (error instanceof RefusalError) this.refused(id, error);
      else this.#take(id)?.fail(error);
    }
  }
}
