/** The moment of a run that is looked at, with its values: the newest wish wins, and live values are asked for again and again only
 * while somebody wants them. */

import { effect, type Signal, signal, untracked } from "@preact/signals-core";
import type { Picture } from "../model/generated/protocol.ts";
import type { Seen } from "../store/run.ts";
import { RefusalError } from "../store/server.ts";
import type { Clock } from "./clock.ts";

export interface LookingPorts {
  readonly clock: Clock;
  /** Asks for a moment; null: the newest there is. */
  readonly ask: (moment: number | null) => Promise<Picture>;
  /** The last event that the page knows of. */
  readonly newest: () => number;
}

/** What could not be had is asked for again after so long. */
const AGAIN_MS = 500;
/** Live values are asked for so often. */
const VALUES_MS = 1_000;
/** So long another moment may stay in sight while the wanted one is on its way. */
const PASSING_MS = 300;

export class Looking {
  readonly moment = signal<number | null>(null);
  readonly seen: Signal<Seen | null> = signal<Seen | null>(null);
  readonly #ports: LookingPorts;
  readonly #unwatch: () => void;
  /** Which moment `seen` shows; undefined: none. */
  #shown: number | null | undefined;
  #wanted = 0;
  #isAsking = false;
  #isOver = false;
  #later: () => void = () => {};
  #passing: () => void = () => {};

  constructor(ports: LookingPorts) {
    this.#ports = ports;
    this.#unwatch = effect(() => {
      const moment = this.moment.value;
      untracked(() => this.#turn(moment));
    });
  }

  /** Says that live values are wanted; returns the way to stop. */
  want(): () => void {
    this.#wanted += 1;
    if (this.#wanted === 1 && this.moment.peek() === null) this.#look();
    let isDone = false;
    return () => {
      if (isDone) return;
      isDone = true;
      this.#wanted -= 1;
      // Nobody keeps them fresh from here on.
      if (this.#wanted === 0 && this.moment.peek() === null) this.#forget();
    };
  }

  close(): void {
    this.#isOver = true;
    this.#unwatch();
    this.#later();
    this.#passing();
  }

  #turn(moment: number | null): void {
    this.#passing();
    if (moment === this.#shown) return;
    if (moment === null || typeof this.#shown !== "number") this.#forget();
    else this.#passing = this.#ports.clock.after(PASSING_MS, () => this.#forget());
    this.#look();
  }

  #forget(): void {
    this.#shown = undefined;
    this.seen.value = null;
  }

  #isWanted(): boolean {
    const moment = this.moment.peek();
    if (moment !== null) return this.#shown !== moment;
    return this.#wanted > 0;
  }

  #look(): void {
    if (this.#isAsking || this.#isOver || !this.#isWanted()) return;
    this.#later();
    this.#isAsking = true;
    void this.#ask().finally(() => {
      this.#isAsking = false;
    });
  }

  async #ask(): Promise<void> {
    const moment = this.moment.peek();
    let wait_ms = moment === null ? VALUES_MS : 0;
    try {
      this.#take(moment, await this.#ports.ask(moment));
    } catch (error) {
      if (!(error instanceof RefusalError)) throw error;
      const isForNow = error.status === 0 || error.status === 429 || error.status >= 500;
      // There is no such moment: the end is what there is to see.
      if (moment !== null && !isForNow && this.moment.peek() === moment) this.moment.value = null;
      wait_ms = moment === this.moment.peek() ? AGAIN_MS : 0;
    }
    this.#lookAgain(this.moment.peek() === moment ? wait_ms : 0);
  }

  #take(moment: number | null, picture: Picture): void {
    if (this.moment.peek() !== moment || this.#isOver) return;
    if (moment === null && this.#wanted === 0) return;
    this.#passing();
    this.#shown = moment;
    this.seen.value = { picture, at_ms: this.#ports.clock.now() };
  }

  #lookAgain(wait_ms: number): void {
    if (this.#isOver || !this.#isWanted()) return;
    this.#later();
    this.#later = this.#ports.clock.after(wait_ms, () => {
      const isShown = this.moment.peek() === null && this.#shown === null;
      const last = this.seen.peek()?.picture.sequence ?? 0;
      if (isShown && last >= this.#ports.newest()) this.#lookAgain(VALUES_MS);
      else this.#look();
    });
  }
}
