/** The one WebSocket to the server, over all its breaks: subscriptions go on from their cursors, and edits are said again until
 * they are answered. Knows frames and times; never what a frame is about. */

import { type Signal, signal } from "@preact/signals-core";
import type { Refusal, ToClient, ToServer } from "../model/generated/protocol.ts";
import type { Follower, Link, Pulse } from "../store/server.ts";
import type { Clock } from "./clock.ts";
import { Outgoing } from "./outgoing.ts";

/** An open, or opening, WebSocket. */
export interface Wire {
  readonly send: (text: string) => void;
  readonly close: () => void;
}

/** What comes over a wire. After `closed` nothing comes. */
export interface WireNews {
  readonly text: (text: string) => void;
  readonly closed: (reason: string) => void;
}

export interface SocketPorts {
  readonly dial: (news: WireNews) => Wire;
  /** Asked after a failed dial: whether the server lets us in at all. */
  readonly probe: () => Promise<"welcome" | "stranger" | "silent">;
  /** Sends what is too large for a frame. */
  readonly post: (frame: ToServer) => Promise<number>;
  readonly clock: Clock;
  /** From 0 to 1, so that not all pages come back at once. */
  readonly random: () => number;
}

/** The server is asked so often whether it is there: what is shown counts as old soon after (`store/age.ts`). */
const PING_MS = 2_000;
/** A connection on which a question stays without any news for so long is taken for dead. */
const SILENCE_MS = 12_000;
/** A connection that does not say welcome for so long is given up. */
const WELCOME_MS = 10_000;
const RETRY_MS = [0, 250, 500, 1_000, 2_000];
/** Refusals by which a server that is about to end asks for patience. */
const LATER = new Set(["server_ends"]);

export class Socket {
  readonly link: Signal<Link> = signal<Link>({ state: "connecting" });
  readonly pulse: Signal<Pulse | null> = signal<Pulse | null>(null);
  readonly #ports: SocketPorts;
  readonly #followers = new Map<number, Follower>();
  readonly #outgoing: Outgoing;
  #wire: Wire | null = null;
  #isUp = false;
  #subscription = 0;
  #ping = 0;
  #pinged_ms = 0;
  #isAnswered = false;
  #tries = 0;
  #heard_ms = 0;
  #isOver = false;
  #cancel: () => void = () => {};

  constructor(ports: SocketPorts) {
    this.#ports = ports;
    this.#outgoing = new Outgoing({
      say: (frame) => this.say(frame),
      post: ports.post,
      soon: (call) => void ports.clock.after(1_000, call),
    });
    this.#dial();
  }

  follow(follower: Follower): () => void {
    this.#subscription += 1;
    const subscription = this.#subscription;
    this.#followers.set(subscription, follower);
    if (this.#isUp) this.#subscribe(subscription, follower);
    return () => {
      if (this.#followers.delete(subscription)) this.say({ frame: "unsubscribe", subscription });
    };
  }

  /** Says what has an id, again after each break, until it is answered: with the revision that it made. */
  ask(id: string, frame: ToServer): Promise<number> {
    return this.#outgoing.ask(id, frame);
  }

  /** Says it if there is a connection. */
  say(frame: ToServer): void {
    if (this.#isUp) this.#wire?.send(JSON.stringify(frame));
  }

  /** Dials at once if there is no connection. */
  retry(): void {
    if (this.#wire || this.#isOver) return;
    this.#tries = 0;
    this.#dial();
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
    this.#cancel();
    const wire = this.#wire;
    this.#wire = null;
    this.#isUp = false;
    this.#outgoing.down();
    wire?.close();
  }

  #dial(): void {
    this.#cancel();
    const wire = this.#ports.dial({
      text: (text) => {
        if (this.#wire === wire) this.#hear(JSON.parse(text) as ToClient);
      },
      closed: (reason) => {
        if (this.#wire === wire) this.#lost(reason);
      },
    });
    this.#wire = wire;
    this.#cancel = this.#ports.clock.after(WELCOME_MS, () => this.#lost("no answer"));
  }

  /** `heard_ms`: since when nothing is heard. */
  #lost(reason: string, heard_ms = this.#ports.clock.now()): void {
    const wasUp = this.#isUp;
    this.#drop();
    const now = this.#ports.clock.now();
    const before = this.link.peek();
    const since_ms = before.state === "down" ? before.since_ms : heard_ms;
    if (wasUp) this.#tries = 0;
    const wait = RETRY_MS[Math.min(this.#tries, RETRY_MS.length - 1)] ?? 0;
    const wait_ms = Math.round(wait * (0.8 + 0.4 * this.#ports.random()));
    this.#tries += 1;
    this.link.value = { state: "down", since_ms, retry_ms: now + wait_ms, reason };
    this.#cancel = this.#ports.clock.after(wait_ms, () => void this.#again());
  }

  async #again(): Promise<void> {
    const verdict = this.#tries > 1 ? await this.#ports.probe() : "welcome";
    if (this.#wire || this.#isOver || this.link.peek().state !== "down") return;
    if (verdict === "stranger") this.refuse("the server asks for a login");
    else if (verdict === "silent") this.#lost("the server does not answer");
    else this.#dial();
  }

  #hear(frame: ToClient): void {
    this.#heard();
    switch (frame.frame) {
      case "welcome":
        this.#welcome(frame);
        break;
      case "pong":
        this.#pong(frame.id, frame.now_ms);
        break;
      case "edited":
        this.#outgoing.answered(frame.id, frame.revision);
        break;
      case "refused":
        this.#refused(frame.id, frame.refusal);
        break;
      case "answer":
        break;
      default:
        this.#told(frame);
    }
  }

  #heard(): void {
    this.#heard_ms = this.#ports.clock.now();
    const pulse = this.pulse.peek();
    if (pulse && this.#heard_ms - pulse.heard_ms >= 1_000) {
      this.pulse.value = { ...pulse, heard_ms: this.#heard_ms };
    }
  }

  #welcome(frame: Extract<ToClient, { frame: "welcome" }>): void {
    this.#isUp = true;
    const heard_ms = this.#heard_ms;
    const delay_ms = this.pulse.peek()?.delay_ms ?? null;
    this.pulse.value = { heard_ms, delay_ms, ahead_ms: frame.now_ms - heard_ms };
    for (const [subscription, follower] of this.#followers) this.#subscribe(subscription, follower);
    this.#outgoing.up();
    this.link.value = { state: "up", session: frame.session, connection: frame.connection };
    this.#beat();
  }

  /** Asks whether the server is there, again and again. */
  #beat(): void {
    this.#ping += 1;
    this.#isAnswered = false;
    this.#pinged_ms = this.#ports.clock.now();
    this.say({ frame: "ping", id: this.#ping });
    this.#listen();
  }

  #listen(): void {
    this.#cancel();
    this.#cancel = this.#ports.clock.after(PING_MS, () => {
      const silence_ms = this.#ports.clock.now() - this.#pinged_ms;
      if (this.#heard_ms > this.#pinged_ms || this.#isAnswered) this.#beat();
      else if (silence_ms >= SILENCE_MS) this.#lost("the server has gone silent", this.#heard_ms);
      else this.#listen();
    });
  }

  #pong(id: number, now_ms: number): void {
    this.#tries = 0;
    if (id !== this.#ping) return;
    this.#isAnswered = true;
    const heard_ms = this.#heard_ms;
    const delay_ms = heard_ms - this.#pinged_ms;
    this.pulse.value = { heard_ms, delay_ms, ahead_ms: now_ms + delay_ms / 2 - heard_ms };
  }

  #subscribe(subscription: number, follower: Follower): void {
    this.say({ frame: "subscribe", subscription, topic: follower.topic() });
  }

  #told(frame: ToClient & { subscription: number }): void {
    const follower = this.#followers.get(frame.subscription);
    const isLast = frame.frame === "reset" || frame.frame === "ended";
    if (isLast) this.#followers.delete(frame.subscription);
    follower?.frame(frame);
  }

  #refused(id: string | null, refusal: Refusal): void {
    if (id !== null && !LATER.has(refusal.code)) this.#outgoing.refused(id, refusal, 409);
  }
}
