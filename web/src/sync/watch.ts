/** One run in the page: follows its truth and its history over every break, gives commands until they are answered, and shows the
 * moment that is looked at. */

import { batch, effect, type Signal, signal } from "@preact/signals-core";
import type {
  Command,
  CommandAnswer,
  Control,
  ControlMove,
  OnCrash,
  Picture,
  RunNow,
  ToClient,
} from "../model/generated/protocol.ts";
import { Journal } from "../store/journal.ts";
import type { Seen, Sent, Watch } from "../store/run.ts";
import { RefusalError, type Server } from "../store/server.ts";
import type { Clock } from "./clock.ts";

export interface WatchPorts {
  readonly server: Server;
  readonly clock: Clock;
  readonly newId: () => string;
}

/** A command is no longer wanted after so long, if nobody says otherwise. */
const PATIENCE_MS = 10_000;
/** A command without an answer is asked for again after so long. */
const AGAIN_MS = 500;
/** So long after its expiry its fate is asked for. Then it is lost. */
const FATE_MS = 600_000;
/** So many answered commands are kept. */
const SENT_MAX = 50;
/** The journal's growth is told so often at most, and live values are asked for. */
const GROWN_MS = 100;
const VALUES_MS = 1_000;

export class RunWatch implements Watch {
  readonly now = signal<RunNow | null>(null);
  readonly heard_ms = signal<number | null>(null);
  readonly journal = new Journal();
  readonly grown = signal(0);
  readonly isCaughtUp = signal(false);
  readonly moment = signal<number | null>(null);
  readonly seen: Signal<Seen | null> = signal<Seen | null>(null);
  readonly sent = signal<readonly Sent[]>([]);
  readonly id: string;
  readonly #ports: WatchPorts;
  readonly #stops: (() => void)[];
  #unfollow: (() => void) | null = null;
  #isTold = false;
  #wanted = signal(0);
  #asking = false;
  #cancel: () => void = () => {};
  #isOver = false;

  constructor(id: string, ports: WatchPorts) {
    this.id = id;
    this.#ports = ports;
    this.#follow();
    const status = ports.server.follow({
      topic: () => ({ topic: "run_status", run: id }),
      frame: (frame) => {
        if (frame.frame === "run_status") this.#stands(frame.status);
      },
    });
    const looking = effect(() => {
      this.moment.value;
      if (this.moment.value !== null || this.#wanted.value > 0) this.#look();
    });
    this.#stops = [status, looking];
  }

  wantValues(): () => void {
    this.#wanted.value += 1;
    let isDone = false;
    return () => {
      if (!isDone) this.#wanted.value -= 1;
      isDone = true;
    };
  }

  async command(command: Command, patience_ms = PATIENCE_MS): Promise<Sent> {
    const sent_ms = this.#ports.clock.now();
    const id = this.#ports.newId();
    const expiry_ms = sent_ms + patience_ms;
    this.#put({ id, command, sent_ms, expiry_ms, answer: null });
    const ahead_ms = this.#ports.server.pulse.peek()?.ahead_ms ?? 0;
    const decided_on = Math.max(0, this.journal.next - 1);
    const expiry = Math.round(expiry_ms + ahead_ms);
    const body = { id, author: "", decided_on, expiry, command };
    const answer = await this.#answered(body, expiry_ms);
    const sent = { id, command, sent_ms, expiry_ms, answer };
    this.#put(sent);
    return sent;
  }

  control(move: ControlMove): Promise<Control> {
    return this.#ports.server.request<Control>("POST", this.#path("control"), move);
  }

  async resume(policy: OnCrash, from: number | null = null): Promise<void> {
    const body = { id: this.#ports.newId(), policy, from };
    await this.#ports.server.request("POST", this.#path("resume"), body);
  }

  close(): void {
    this.#isOver = true;
    for (const stop of this.#stops) stop();
    this.#unfollow?.();
    this.#cancel();
  }

  #path(what: string): string {
    return `/runs/${encodeURIComponent(this.id)}/${what}`;
  }

  #follow(): void {
    this.#isTold = false;
    this.#unfollow = this.#ports.server.follow({
      topic: () => ({ topic: "run_history", run: this.id, from: this.journal.next, values: false }),
      frame: (frame) => this.#hear(frame),
    });
  }

  #hear(frame: ToClient): void {
    if (frame.frame === "ended") {
      this.#isTold = true;
      this.#unfollow = null;
      if (frame.refusal === null) this.isCaughtUp.value = true;
    } else if (frame.frame === "events") {
      this.journal.add(frame.events, frame.next);
      if (frame.events.length === 0) this.isCaughtUp.value = true;
      this.#soonTold();
    }
  }

  #stands(now: RunNow): void {
    batch(() => {
      this.now.value = now;
      this.heard_ms.value = this.#ports.clock.now();
    });
    const isLive = now.run.phase === "live" || now.run.phase === "starting";
    if (this.#isTold && (isLive || (now.snapshot?.disk_safe ?? 0) >= this.journal.next)) {
      this.#follow();
    }
  }

  #soonTold(): void {
    if (this.#isSoon) return;
    this.#isSoon = true;
    this.#cancel = this.#ports.clock.after(GROWN_MS, () => {
      this.#isSoon = false;
      this.grown.value = this.journal.length;
    });
  }

  #isSoon = false;

  /** Asks for the moment, and while live again and again as long as values are wanted. */
  #look(): void {
    if (this.#asking || this.#isOver) return;
    this.#asking = true;
    void this.#lookNow().finally(() => {
      this.#asking = false;
      this.#lookAgain();
    });
  }

  #lookAgain(): void {
    const moment = this.moment.peek();
    const shown = this.seen.peek()?.picture.sequence;
    if (moment !== null && shown !== moment) this.#look();
    if (moment !== null || this.#wanted.peek() === 0) return;
    this.#ports.clock.after(VALUES_MS, () => {
      const isNew = (this.seen.peek()?.picture.sequence ?? 0) < this.journal.next - 1;
      if (this.moment.peek() !== null || this.#wanted.peek() === 0) return;
      if (isNew) this.#look();
      else this.#lookAgain();
    });
  }

  async #lookNow(): Promise<void> {
    const moment = this.moment.peek();
    const path = this.#path(moment === null ? "moments" : `moments/${moment}`);
    try {
      const picture = await this.#ports.server.request<Picture>("GET", path);
      if (this.moment.peek() === moment) {
        this.seen.value = { picture, at_ms: this.#ports.clock.now() };
      }
    } catch (error) {
      if (!(error instanceof RefusalError)) throw error;
      if (moment !== null && error.status !== 0 && this.moment.peek() === moment) {
        this.moment.value = null;
      }
      await this.#wait(AGAIN_MS);
    }
  }

  #wait(ms: number): Promise<void> {
    return new Promise((over) => this.#ports.clock.after(ms, over));
  }

  async #answered(body: { readonly id: string }, expiry_ms: number): Promise<Sent["answer"]> {
    for (;;) {
      try {
        const path = this.#path("commands");
        const { id: _, ...answer } = await this.#ports.server.request<CommandAnswer>(
          "POST",
          path,
          body,
        );
        return answer;
      } catch (error) {
        if (!(error instanceof RefusalError)) throw error;
        const isForNow = error.status === 0 || error.status === 503 || error.status === 429;
        if (!isForNow) return { answer: "refused", reason: error.message };
        const isLost = this.#isOver || this.#ports.clock.now() > expiry_ms + FATE_MS;
        if (isLost) return { answer: "lost", reason: error.message };
        await this.#wait(AGAIN_MS);
      }
    }
  }

  #put(sent: Sent): void {
    const others = this.sent.peek().filter(({ id }) => id !== sent.id);
    const at = this.sent.peek().findIndex(({ id }) => id === sent.id);
    const all = at < 0 ? [...others, sent] : others.toSpliced(at, 0, sent);
    const surplus = Math.max(0, all.length - SENT_MAX);
    this.sent.value = all.filter(({ answer }, index) => answer === null || index >= surplus);
  }
}
