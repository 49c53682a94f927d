/** Loads the moment at the playhead with its values: the newest request wins, and live values are requested periodically while they are
 * needed. */

import { effect, type Signal, signal, untracked } from "@preact/signals-core";
import type { Moment } from "../model/generated/protocol.ts";
import type { RunSnapshot } from "../store/history/run.ts";
import { RefusalError } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";

interface SnapshotLoaderPorts {
  readonly clock: Clock;
  /** Asks for a moment; null: the newest there is. */
  readonly ask: (playhead: number | null) => Promise<Moment>;
  /** The last event that the page knows of. */
  readonly newest: () => number;
}

/** Retry interval of a failed request, in ms. */
const AGAIN_MS = 500;
/** Interval of requests for live values, in ms. */
const VALUES_MS = 1_000;
/** Time in which another moment stays visible during a request, in ms. */
const PASSING_MS = 300;

export class SnapshotLoader {
  readonly playhead = signal<number | null>(null);
  readonly snapshot: Signal<RunSnapshot | null> = signal<RunSnapshot | null>(null);
  readonly #ports: SnapshotLoaderPorts;
  readonly #unwatch: () => void;
  /** Which moment `snapshot` shows; undefined: none. */
  #shown: number | null | undefined;
  #wanted = 0;
  #isAsking = false;
  #isOver = false;
  #later: () => void = () => {};
  #passing: () => void = () => {};

  constructor(ports: SnapshotLoaderPorts) {
    this.#ports = ports;
    this.#unwatch = effect(() => {
      const playhead = this.playhead.value;
      untracked(() => this.#turn(playhead));
    });
  }

  /** Requests live values; the returned function ends that. */
  want(): () => void {
    this.#wanted += 1;
    if (this.#wanted === 1 && this.playhead.peek() === null) this.#look();
    let isDone = false;
    return () => {
      if (isDone) return;
      isDone = true;
      this.#wanted -= 1;
      // Nobody keeps them fresh from here on.
      if (this.#wanted === 0 && this.playhead.peek() === null) this.#forget();
    };
  }

  close(): void {
    this.#isOver = true;
    this.#unwatch();
    this.#later();
    this.#passing();
  }

  #turn(playhead: number | null): void {
    this.#passing();
    if (playhead === this.#shown) return;
    if (playhead === null || typeof this.#shown !== "number") this.#forget();
    else this.#passing = this.#ports.clock.after(PASSING_MS, () => this.#forget());
    this.#look();
  }

  #forget(): void {
    this.#shown = undefined;
    this.snapshot.value = null;
  }

  #isWanted(): boolean {
    const playhead = this.playhead.peek();
    if (playhead !== null) return this.#shown !== playhead;
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
    const playhead = this.playhead.peek();
    let wait_ms = playhead === null ? VALUES_MS : 0;
    try {
      this.#take(playhead, await this.#ports.ask(playhead));
    } catch (error) {
      if (!(error instanceof RefusalError)) throw error;
      // There is no such moment: the end is what there is to see.
      if (playhead !== null && !error.isForNow && this.playhead.peek() === playhead)
        this.playhead.value = null;
      wait_ms = playhead === this.playhead.peek() ? AGAIN_MS : 0;
    }
    this.#lookAgain(this.playhead.peek() === playhead ? wait_ms : 0);
  }

  #take(playhead: number | null, picture: Moment): void {
    if (this.playhead.peek() !== playhead || this.#isOver) return;
    if (playhead === null && this.#wanted === 0) return;
    this.#passing();
    this.#shown = playhead;
    this.snapshot.value = { picture, at_ms: this.#ports.clock.now() };
  }

  #lookAgain(wait_ms: number): void {
    if (this.#isOver || !this.#isWanted()) return;
    this.#later();
    this.#later = this.#ports.clock.after(wait_ms, () => {
      const isShown = this.playhead.peek() === null && this.#shown === null;
      const last = this.snapshot.peek()?.picture.sequence ?? 0;
      if (isShown && last >= this.#ports.newest()) this.#lookAgain(VALUES_MS);
      else this.#look();
    });
  }
}
