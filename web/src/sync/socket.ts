/** The connection to the server across disconnections: subscriptions continue at their cursors. A silent WebSocket stays open while
 * another one is dialled, and the first that responds is used, so a slow network never counts as a dead one. Knows frames, not their
 * content. */

import { type Signal, signal } from "@preact/signals-core";
import { FRAMES_VERSION, type ToClient, type ToServer } from "../model/generated/protocol.ts";
import type { AnswerFrame, Follower, Link, ServerPulse } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";
import { type Delay, PING_MS } from "./delay.ts";

/** An open, or opening, WebSocket. */
export interface Wire {
  readonly send: (text: string) => void;
  readonly close: () => void;
}

/** Events of a connection. `closed` is the last one. */
export interface WireNews {
  readonly text: (text: string) => void;
  readonly closed: (reason: string) => void;
}

/** Answer of the server to the page; `turnedAway` is the reason if it refuses the page's address. */
export type Verdict = "welcome" | "stranger" | "silent" | { readonly turnedAway: string };

interface SocketPorts {
  readonly dial: (news: WireNews) => Wire;
  /** All limits of time. */
  readonly delay: Delay;
  /** Asked after a dial that was turned away: whether the server lets us in at all. */
  readonly probe: () => Promise<Verdict>;
  readonly clock: Clock;
  /** From 0 to 1, so that not all pages come back at once. */
  readonly random: () => number;
}

const RETRY_MS = [0, 250, 500, 1_000, 2_000];
/** Refusals that count for now only. */
const LATER = new Set(["server_ends"]);

/** One WebSocket, from its dial to its end. */
interface SocketConnection {
  readonly wire: Wire;
  readonly dialled_ms: number;
  /** The subscriptions that the server has of it. */
  readonly subscribed: Set<number>;
  heard_ms: number;
  /** Since when a question waits without any news; null: none does. */
  waits_ms: number | null;
  /** As what it is up, from its welcome on. */
  up: Extract<Link, { state: "up" }> | null;
}

export class Socket {
  readonly link: Signal<Link> = signal<Link>({ state: "connecting" });
  readonly pulse: Signal<ServerPulse | null> = signal<ServerPulse | null>(null);
  readonly #ports: SocketPorts;
  readonly #followers = new Map<number, Follower>();
  readonly #listeners = new Set<(frame: AnswerFrame) => void>();
  /** The one that is up. */
  #connection: SocketConnection | null = null;
  #dialled: SocketConnection | null = null;
  /** It was up, and may speak again. */
  #silent: SocketConnection | null = null;
  #subscription = 0;
  #tries = 0;
  /** Dials in a row without an answer. */
  #unanswered = 0;
  #isOver = false;
  #cancel: () => void = () => {};

  constructor(ports: SocketPorts) {
    this.#ports = ports;
    this.#dial();
  }

  follow(follower: Follower): () => void {
    this.#subscription += 1;
    const subscription = this.#subscription;
    this.#followers.set(subscription, follower);
    if (this.#connection) this.#subscribe(this.#connection, subscription, follower);
    return () => {
      if (this.#followers.delete(subscription)) this.#unsubscribe(this.#connection, subscription);
    };
  }

  /** Reports answers to messages with an id. */
  onAnswer(listener: (frame: AnswerFrame) => void): () => void {
    this.#listeners.add(listener);
    return () => void this.#listeners.delete(listener);
  }

  /** Sends it if there is a connection. */
  say(frame: ToServer): void {
    this.#connection?.wire.send(JSON.stringify(frame));
  }

  /** Dials at once if there is no connection, and none has just been dialled. */
  retry(): void {
    if (this.#connection || this.#isOver) return;
    const dialled_ms = this.#dialled?.dialled_ms ?? 0;
    if (this.#ports.clock.now() - dialled_ms < this.#ports.delay.old_ms) return;
    this.#tries = 0;
    this.#hangUp();
    this.#dial();
  }

  /** Another response of the server shows that the network works. */
  alive(): void {
    if (this.#connection) this.#connection.waits_ms = null;
  }

  /** Nobody is let in any more without a login. */
  refuse(reason: string): void {
    this.#drop();
    this.link.value = { state: "refused", reason };
  }

  /** Ends it for good. */
  close(): void {
    this.#isOver = true;
    this.#drop();
  }

  #drop(): void {
    this.#hangUp();
    for (const connection of [this.#connection, this.#silent]) connection?.wire.close();
    [this.#connection, this.#silent] = [null, null];
  }

  /** Gives the dial up, and all that was to come later. */
  #hangUp(): void {
    this.#cancel();
    this.#dialled?.wire.close();
    this.#dialled = null;
  }

  #dial(): void {
    const { clock, delay, dial } = this.#ports;
    this.#hangUp();
    const now_ms = clock.now();
    const wire = dial({
      text: (text) => this.#hear(connection, JSON.parse(text) as ToClient),
      closed: (reason) => this.#closed(connection, reason),
    });
    const times = { dialled_ms: now_ms, heard_ms: now_ms, waits_ms: null };
    const connection: SocketConnection = { wire, ...times, subscribed: new Set(), up: null };
    this.#dialled = connection;
    this.#cancel = clock.after(delay.dial_ms(this.#unanswered), () => {
      this.#unanswered += 1;
      this.#hangUp();
      this.#down("no answer", clock.now(), () => this.#dial());
    });
  }

  #closed(connection: SocketConnection, reason: string): void {
    if (connection === this.#silent) this.#silent = null;
    if (connection === this.#dialled) {
      this.#hangUp();
      this.#unanswered = 0;
      this.#down(reason, this.#ports.clock.now(), () => void this.#again());
    } else if (connection === this.#connection) {
      this.#connection = null;
      this.#lost(reason, this.#ports.clock.now());
    }
  }

  /** The connection is lost. `heard_ms` is the time of the last message. */
  #lost(reason: string, heard_ms: number): void {
    this.#cancel();
    [this.#tries, this.#unanswered] = [0, 0];
    this.#down(reason, heard_ms, () => this.#dial());
  }

  /** Says so, and does something about it soon. */
  #down(reason: string, heard_ms: number, then: () => void): void {
    const now = this.#ports.clock.now();
    const before = this.link.peek();
    const since_ms = before.state === "down" ? before.since_ms : heard_ms;
    const wait = RETRY_MS[Math.min(this.#tries, RETRY_MS.length - 1)] ?? 0;
    const wait_ms = Math.round(wait * (0.8 + 0.4 * this.#ports.random()));
    this.#tries += 1;
    this.link.value = { state: "down", since_ms, retry_ms: now + wait_ms, reason };
    this.#cancel = this.#ports.clock.after(wait_ms, then);
  }

  async #again(): Promise<void> {
    const verdict = this.#tries > 1 ? await this.#verdict() : "welcome";
    if (this.#connection || this.#dialled || this.#isOver || this.link.peek().state !== "down")
      return;
    if (verdict === "stranger") this.refuse("the server requires a login");
    else if (verdict === "welcome") this.#dial();
    else if (verdict !== "silent") this.refuse(verdict.turnedAway);
    else {
      const then = () => void this.#again();
      this.#down("the server does not respond", this.#ports.clock.now(), then);
    }
  }

  /** Result of a login probe; `silent` without an answer in time. */
  #verdict(): Promise<Verdict> {
    const { clock, delay, probe } = this.#ports;
    const late = new Promise<"silent">((over) => {
      clock.after(delay.request_ms(true, 0), () => over("silent"));
    });
    return Promise.race([probe(), late]);
  }

  #hear(connection: SocketConnection, frame: ToClient): void {
    if (connection === this.#silent) this.#revive(connection);
    if (frame.frame === "welcome" && connection === this.#dialled) this.#welcome(connection, frame);
    if (connection !== this.#connection) return;
    this.#received(connection);
    switch (frame.frame) {
      case "pong":
        this.#pong(frame.id, frame.now_ms);
        break;
      case "edited":
        this.#answer(frame);
        break;
      case "refused":
        // A server that is about to end asks for patience.
        if (!LATER.has(frame.refusal.code)) this.#answer(frame);
        break;
      case "welcome":
      case "answer":
        break;
      default:
        this.#deliver(connection, frame);
    }
  }

  #received(connection: SocketConnection): void {
    const now_ms = this.#ports.clock.now();
    [connection.heard_ms, connection.waits_ms] = [now_ms, null];
    const pulse = this.pulse.peek();
    if (pulse && now_ms - pulse.heard_ms >= 1_000) {
      this.pulse.value = { ...pulse, heard_ms: now_ms };
    }
  }

  #welcome(connection: SocketConnection, frame: Extract<ToClient, { frame: "welcome" }>): void {
    if (frame.protocol !== FRAMES_VERSION) {
      this.refuse("the server and this page have different versions: reload the page");
      return;
    }
    const { clock, delay } = this.#ports;
    const now_ms = clock.now();
    this.#cancel();
    [this.#connection, this.#dialled, this.#unanswered] = [connection, null, 0];
    this.#silent?.wire.close();
    this.#silent = null;
    delay.dialled(now_ms - connection.dialled_ms, frame.now_ms, now_ms);
    connection.up = { state: "up", session: frame.session, connection: frame.connection };
    // Data of the earlier connection keeps its age: the followers update before this one counts.
    this.#catchUp(connection);
    this.#tell(this.pulse.peek()?.delay_ms ?? null, frame.now_ms);
    this.link.value = connection.up;
    this.#beat(connection);
  }

  /** It only was silent: what was held back comes, and nothing is asked for again. */
  #revive(connection: SocketConnection): void {
    this.#hangUp();
    [this.#connection, this.#silent, this.#tries, this.#unanswered] = [connection, null, 0, 0];
    this.#catchUp(connection);
    if (connection.up) this.link.value = connection.up;
    this.#beat(connection);
  }

  /** Subscribes to what is followed, and to nothing else. */
  #catchUp(connection: SocketConnection): void {
    for (const subscription of [...connection.subscribed]) {
      if (!this.#followers.has(subscription)) this.#unsubscribe(connection, subscription);
    }
    for (const [subscription, follower] of this.#followers) {
      if (!connection.subscribed.has(subscription))
        this.#subscribe(connection, subscription, follower);
    }
  }

  /** Pings the server periodically. */
  #beat(connection: SocketConnection): void {
    const { clock, delay } = this.#ports;
    const now_ms = clock.now();
    connection.waits_ms ??= now_ms;
    this.say({ frame: "ping", id: delay.ask(now_ms) });
    this.#cancel();
    this.#cancel = clock.after(PING_MS, () => {
      const silent_ms = connection.waits_ms === null ? 0 : clock.now() - connection.waits_ms;
      if (silent_ms < delay.silent_ms) return this.#beat(connection);
      [this.#connection, this.#silent] = [null, connection];
      this.#lost("the server stopped responding", connection.heard_ms);
    });
  }

  #pong(id: number, server_ms: number): void {
    this.#tries = 0;
    const { clock, delay } = this.#ports;
    const round_ms = delay.answer(id, server_ms, clock.now());
    if (round_ms !== null) this.#tell(round_ms, server_ms);
  }

  #tell(delay_ms: number | null, server_ms: number): void {
    const { ahead_ms, old_ms } = this.#ports.delay;
    const heard_ms = this.#ports.clock.now();
    this.pulse.value = { heard_ms, delay_ms, ahead_ms, server_ms, old_ms };
  }

  #subscribe(
    { wire, subscribed }: SocketConnection,
    subscription: number,
    follower: Follower,
  ): void {
    subscribed.add(subscription);
    wire.send(JSON.stringify({ frame: "subscribe", subscription, topic: follower.topic() }));
  }

  #unsubscribe(connection: SocketConnection | null, subscription: number): void {
    if (connection?.subscribed.delete(subscription)) {
      connection.wire.send(JSON.stringify({ frame: "unsubscribe", subscription }));
    }
  }

  #deliver(connection: SocketConnection, frame: ToClient & { subscription: number }): void {
    const follower = this.#followers.get(frame.subscription);
    const isLast = frame.frame === "reset" || frame.frame === "ended";
    if (isLast) {
      this.#followers.delete(frame.subscription);
      connection.subscribed.delete(frame.subscription);
    }
    follower?.frame(frame);
  }

  #answer(frame: AnswerFrame): void {
    for (const listener of this.#listeners) listener(frame);
  }
}
