/** One run in the page: follows its truth and its history over every break. Commands and moments have their own files. */

import { batch, effect, type Signal, signal, untracked } from "@preact/signals-core";
import type {
  Before,
  Command,
  Control,
  ControlMove,
  EarlierHistory,
  HistoryEntry,
  OnCrash,
  Refusal,
  RunNow,
  StartedRun,
  ToClient,
} from "../model/generated/protocol.ts";
import { isLive } from "../model/run_words.ts";
import { type AheadValues, NOTHING_AHEAD } from "../store/history/ahead.ts";
import { Journal } from "../store/history/journal.ts";
import { rolled, withBase } from "../store/history/rolled.ts";
import type { RunSnapshot, SentCommand, Watch } from "../store/history/run.ts";
import { LatestRequest } from "../store/page/latest_request.ts";
import { REPEATED, type Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";
import { CommandOutbox, lifetimeOverLink_ms } from "./command_outbox.ts";
import { PastWindows } from "./past_windows.ts";
import { requestUntilAnswered, StartRequests } from "./request_until_answered.ts";
import { SnapshotLoader } from "./snapshot_loader.ts";

export interface WatchPorts {
  readonly server: Server;
  readonly clock: Clock;
  readonly newId: () => string;
}

/** Shortest interval of reports on the journal's growth, in ms. */
const GROWN_MS = 100;
/** Capacity of the events for a run of any length, and the number of newest events that stay. */
const EVENTS_MAX = 200_000;
const EVENTS_KEPT = 100_000;
/** Number of newest events that are loaded first of a longer run. */
const NEWEST = 10_000;
/** Retry interval of a failed subscription or request, in ms. */
const AGAIN_MS = 1_000;
/** Refusals that stay: no such run, or no such history. */
const FOR_GOOD = new Set(["no_such_run", "no_history", "journal_too_short"]);

export class RunWatch implements Watch {
  readonly now = signal<RunNow | null>(null);
  readonly proven_ms = signal<number | null>(null);
  readonly isCurrent = signal(false);
  #journal = new Journal();
  readonly #windows: PastWindows;
  /** Requests the state before the journal. */
  readonly #earlier: LatestRequest<Before, EarlierHistory>;
  readonly #unwatch: () => void;
  readonly journalVersion = signal(0);
  readonly isCaughtUp = signal(false);
  readonly lack = signal<string | null>(null);
  readonly playhead: Signal<number | null>;
  readonly playheadSnapshot: Signal<RunSnapshot | null>;
  readonly sent: Signal<readonly SentCommand[]>;
  readonly ahead = signal<AheadValues>(NOTHING_AHEAD);
  readonly id: string;
  readonly #starts: StartRequests;
  readonly #ports: WatchPorts;
  readonly #outbox: CommandOutbox;
  readonly #snapshots: SnapshotLoader;
  #unfollowHistory: () => void = () => {};
  #unfollowStatus: () => void = () => {};
  /** Number of received events, and of replaced journals. */
  #version = 0;
  /** True if nothing more of the history arrives by itself. */
  #hasHistoryEnded = false;
  #isSoon = false;
  #isOver = false;
  readonly #followers: (() => void)[] = [];

  constructor(id: string, ports: WatchPorts) {
    this.id = id;
    this.#ports = ports;
    this.#starts = new StartRequests(ports);
    const { server, clock } = ports;
    this.#outbox = new CommandOutbox({
      ...ports,
      path: this.#path("commands"),
      decidedOn: () => this.journal.next - 1,
      linkLifetime_ms: (bytes, server_ms) =>
        lifetimeOverLink_ms(this.now.peek()?.robot, bytes, server_ms),
    });
    this.#snapshots = new SnapshotLoader({
      clock,
      ask: (at) => {
        const path = this.#path(at === null ? "moments" : `moments/${at}`);
        return server.request("GET", path, undefined, REPEATED);
      },
      newest: () => Math.max(this.journal.next - 1, this.#written()),
    });
    this.#windows = new PastWindows({
      clock,
      ask: (what) => server.request("GET", this.#path(what), undefined, REPEATED),
      changed: () => this.#changed(),
    });
    this.#earlier = new LatestRequest({
      ask: ({ sequence }) =>
        server.request("GET", this.#path(`earlier/${sequence}`), undefined, REPEATED),
      take: (earlier, before) => {
        this.#journal = withBase(this.#journal, { before, earlier });
        this.#changed();
      },
      again_ms: AGAIN_MS,
      after: clock.after,
    });
    this.sent = this.#outbox.sent;
    this.playhead = this.#snapshots.playhead;
    this.playheadSnapshot = this.#snapshots.snapshot;
    this.#unwatch = effect(() => {
      const playhead = this.playhead.value;
      untracked(() => this.#look(playhead));
    });
    // In this order: the status arrives before the events.
    this.#followStatus();
    this.#followHistory();
  }

  get journal(): Journal {
    return this.#journal;
  }

  get window(): Journal {
    const playhead = this.playhead.peek();
    if (playhead === null || this.#isHere(playhead)) return this.#journal;
    return this.#windows.at(playhead) ?? this.#windows.last ?? this.#journal;
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

  startAgain(): Promise<StartedRun> {
    return this.#starts.start<StartedRun>(this.#path("again"), {});
  }

  close(): void {
    this.#isOver = true;
    this.#unwatch();
    this.#windows.close();
    this.#earlier.close();
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

  /** Last event on the disk, reported by the server. */
  #written(): number {
    return this.now.peek()?.snapshot?.disk_safe ?? 0;
  }

  /** The server's time of the last message. */
  #server_ms(): number | null {
    return this.#ports.server.pulse.peek()?.server_ms ?? null;
  }

  #followHistory(): void {
    this.#hasHistoryEnded = false;
    this.#unfollowHistory = this.#ports.server.follow({
      topic: () => {
        // Events of a disconnection arrive first.
        this.isCaughtUp.value = false;
        const from = this.journal.next;
        return { topic: "run_newest", run: this.id, from, most: EVENTS_MAX, newest: NEWEST };
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
      this.#add(frame.events, frame.next);
      for (const { event } of frame.events) this.#outbox.received(event);
      if (frame.events.length === 0) this.isCaughtUp.value = true;
      this.#publishSoon();
    } else if (frame.frame === "skipped") {
      this.#become(new Journal({ before: frame.before, earlier: null }));
    } else if (frame.frame === "ended") {
      this.#hasHistoryEnded = true;
      this.lack.value = frame.refusal?.message ?? null;
      if (frame.refusal === null) this.isCaughtUp.value = true;
      this.#again(frame.refusal, () => this.#hasHistoryEnded && this.#followHistory());
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
    if (this.#hasHistoryEnded && (isLive(now.run.phase) || this.#written() >= this.journal.next))
      this.#followHistory();
  }

  #add(events: readonly HistoryEntry[], next: number): void {
    const before = this.#journal.length;
    this.#journal.add(events, next);
    this.#version += this.#journal.length - before;
    if (this.#journal.length > EVENTS_MAX) this.#become(rolled(this.#journal, EVENTS_KEPT));
  }

  /** Goes on as another journal. The one before stays if the moment that is shown is in it. */
  #become(journal: Journal): void {
    const playhead = this.playhead.peek();
    const isShown = playhead !== null && this.#isHere(playhead);
    if (isShown && !journal.covers(playhead)) this.#windows.keep(this.#journal);
    this.#journal = journal;
    this.#changed();
    this.#learn();
  }

  #isHere(playhead: number): boolean {
    return this.#journal.base === null || this.#journal.covers(playhead);
  }

  #look(playhead: number | null): void {
    const isPast = playhead !== null && !this.#isHere(playhead);
    this.#windows.want(isPast && playhead < this.#journal.from ? playhead : null);
  }

  /** Asks for the state before the journal unless it is known. */
  #learn(): void {
    const { base } = this.#journal;
    if (base && !base.earlier) this.#earlier.want(base.before);
    else this.#earlier.drop();
  }

  /** A journal is another one than before. */
  #changed(): void {
    this.#version += 1;
    this.#publishSoon();
  }

  #publishSoon(): void {
    if (this.#isSoon) return;
    this.#isSoon = true;
    this.#ports.clock.after(GROWN_MS, () => {
      this.#isSoon = false;
      if (!this.#isOver) this.journalVersion.value = this.#version;
    });
  }
}
