/** One run in the page: follows its truth and its history over every break. Commands and moments have their own files. */

import { batch, type Signal, signal } from "@preact/signals-core";
import type {
  Command,
  Control,
  ControlMove,
  OnCrash,
  Refusal,
  RunNow,
  ToClient,
} from "../model/generated/protocol.ts";
import { Journal } from "../store/history/journal.ts";
import type { RunSnapshot, SentCommand, Watch } from "../store/history/run.ts";
import { REPEATED, type Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";
import { CommandOutbox } from "./command_outbox.ts";
import { requestUntilAnswered } from "./request_until_answered.ts";
import { SnapshotLoader } from "./snapshot_loader.ts";

export interface WatchPorts {
  readonly server: Server;
  readonly clock: Clock;
  readonly newId: () => string;
}

/** The journal's growth is told so often at most. */
const GROWN_MS = 100;
/** What could not be followed is tried again after so long. */
const AGAIN_MS = 1_000;
/** Refusals that stay: no such run, or no such history. */
const FOR_GOOD = new Set(["no_such_run", "no_history", "journal_too_short"]);

export class RunWatch implements Watch {
  readonly now = signal<RunNow | null>(null);
  readonly proven_ms = signal<number | null>(null);
  readonly isCurrent = signal(false);
  readonly journal = new Journal();
  readonly journalVersion = signal(0);
  readonly isCaughtUp = signal(false);
  readonly lack = signal<string | null>(null);
  readonly playhead: Signal<number | null>;
  readonly playheadSnapshot: Signal<RunSnapshot | null>;
  readonly sent: Signal<readonly SentCommand[]>;
  readonly id: string;
  readonly #ports: WatchPorts;
  readonly #outbox: CommandOutbox;
  readonly #snapshots: SnapshotLoader;
  #unfollowHistory: () => void = () => {};
  #unfollowStatus: () => void = () => {};
  /** Whether nothing more of the history will come by itself. */
  #isTold = false;
  #isSoon = false;
  #isOver = false;
  readonly #followers: (() => void)[] = [];

  constructor(id: string, ports: WatchPorts) {
    this.id = id;
    this.#ports = ports;
    const { server, clock } = ports;
    this.#outbox = new CommandOutbox({
      ...ports,
      path: this.#path("commands"),
      decidedOn: () => this.journal.next - 1,
    });
    this.#snapshots = new SnapshotLoader({
      clock,
      ask: (at) => {
        const path = this.#path(at === null ? "moments" : `moments/${at}`);
        return server.request("GET", path, undefined, REPEATED);
      },
      newest: () => Math.max(this.journal.next - 1, this.#written()),
    });
    this.sent = this.#outbox.sent;
    this.playhead = this.#snapshots.playhead;
    this.playheadSnapshot = this.#snapshots.snapshot;
    // In this order: how it stands comes before all that happened.
    this.#followStatus();
    this.#followHistory();
  }

  wantValues(): () => void {
    return this.#snapshots.want();
  }

  command(command: Command, patience_ms?: number): Promise<SentCommand> {
    return this.#outbox.send(command, patience_ms);
  }

  control(move: ControlMove): Promise<Control> {
    return this.#ports.server.request<Control>("POST", this.#path("control"), move);
  }

  async resume(policy: OnCrash, from: number | null = null): Promise<void> {
    const body = { id: this.#ports.newId(), policy, from };
    await requestUntilAnswered(this.#ports, this.#path("resume"), body);
  }

  close(): void {
    this.#isOver = true;
    this.#unfollowHistory();
    this.#unfollowStatus();
    this.#outbox.close();
    this.#snapshots.close();
    for (const call of this.#followers.splice(0)) call();
  }

  readonly whenClosed = (call: () => void): void => {
    if (this.#isOver) call();
    else this.#followers.push(call);
  };

  #path(what: string): string {
    return `/runs/${encodeURIComponent(this.id)}/${what}`;
  }

  /** The last event that is on disk, as the server says. */
  #written(): number {
    return this.now.peek()?.snapshot?.disk_safe ?? 0;
  }

  /** The server's time when it said what was heard last. */
  #server_ms(): number | null {
    return this.#ports.server.pulse.peek()?.server_ms ?? null;
  }

  #followHistory(): void {
    this.#isTold = false;
    this.#unfollowHistory = this.#ports.server.follow({
      topic: () => {
        // What happened during a break is told first.
        this.isCaughtUp.value = false;
        return { topic: "run_history", run: this.id, from: this.journal.next, values: false };
      },
      frame: (frame) => this.#hear(frame),
    });
  }

  #followStatus(): void {
    this.#unfollowStatus = this.#ports.server.follow({
      topic: () => {
        if (this.isCurrent.peek()) this.proven_ms.value = this.#server_ms();
        this.isCurrent.value = false;
        return { topic: "run_status", run: this.id };
      },
      frame: (frame) => {
        if (frame.frame === "run_status") this.#receiveStatus(frame.status);
        else if (frame.frame === "ended") this.#again(frame.refusal, () => this.#followStatus());
      },
    });
  }

  #hear(frame: ToClient): void {
    if (frame.frame === "events") {
      this.lack.value = null;
      this.journal.add(frame.events, frame.next);
      for (const { event } of frame.events) this.#outbox.received(event);
      if (frame.events.length === 0) this.isCaughtUp.value = true;
      this.#soonTold();
    } else if (frame.frame === "ended") {
      this.#isTold = true;
      this.lack.value = frame.refusal?.message ?? null;
      if (frame.refusal === null) this.isCaughtUp.value = true;
      this.#again(frame.refusal, () => this.#isTold && this.#followHistory());
    }
  }

  /** Tries again soon, unless it is no use. */
  #again(refusal: Refusal | null, follow: () => void): void {
    if (refusal === null || FOR_GOOD.has(refusal.code)) return;
    this.#ports.clock.after(AGAIN_MS, () => {
      if (!this.#isOver) follow();
    });
  }

  #receiveStatus(now: RunNow): void {
    batch(() => {
      this.now.value = now;
      this.proven_ms.value = Math.max(now.now_ms, this.#server_ms() ?? now.now_ms);
      this.isCurrent.value = true;
    });
    const isLive = now.run.phase === "live" || now.run.phase === "starting";
    if (this.#isTold && (isLive || this.#written() >= this.journal.next)) this.#followHistory();
  }

  #soonTold(): void {
    if (this.#isSoon) return;
    this.#isSoon = true;
    this.#ports.clock.after(GROWN_MS, () => {
      this.#isSoon = false;
      if (!this.#isOver) this.journalVersion.value = this.journal.length;
    });
  }
}
