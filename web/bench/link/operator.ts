/** An operator: a program of its own that follows a run at a server over the documented WebSocket, over all breaks, and commands.
 * It notes what it was shown and when. As it is a process, it can be put to sleep. */

import { type ChildProcess, fork } from "node:child_process";
import { once } from "node:events";
import WebSocket from "ws";
import type { Answer, Command, Envelope, ToClient } from "../../src/model/generated/protocol.ts";
import { type Host, owned } from "./host.ts";

/** Whom it stands for and where it looks. */
interface Post {
  readonly name: string;
  readonly url: string;
  readonly token: string;
  readonly run: string;
}

/** A command and what became of it; times by this computer's clock, in ms. */
export interface Given {
  readonly id: string;
  readonly type: string;
  readonly sent_ms: number;
  readonly expiry_ms: number | null;
  answered_ms: number | null;
  answer: Answer["answer"] | "lost" | null;
}

/** What an operator was shown. */
export interface Notes {
  /** The sequence of each event and when it came. */
  readonly events: readonly (readonly [number, number])[];
  /** Up to which event a status went, when it came, whether the run was paused. */
  readonly statuses: readonly (readonly [number, number, boolean])[];
  readonly given: readonly Given[];
  /** Events that came twice or out of order. */
  readonly twice: number;
  /** Up to which event everything came. */
  readonly receivedUpTo: number;
}

type Order =
  | { readonly order: "command"; readonly command: Command; readonly valid_ms: number | null }
  | { readonly order: "notes" };

const COMMAND_MS = 10_000;
const HISTORY = 1;
const STATUS = 2;

/** As the program that put it there sees it. */
export class Operator {
  readonly name: string;
  readonly token: string;
  /** Where it sits. */
  readonly host: Host;
  readonly #process: ChildProcess;

  constructor(post: Post, host: Host) {
    [this.name, this.token, this.host] = [post.name, post.token, host];
    const words = ["operator", JSON.stringify(post)];
    const [execPath = "", ...execArgv] = [...host.inside, process.execPath];
    const stdio = ["ignore", "inherit", "inherit", "ipc"] as const;
    const options = { execPath, execArgv, stdio: [...stdio] };
    this.#process = owned(fork(process.argv[1] ?? "", words, options));
  }

  command(command: Command, valid_ms: number | null = COMMAND_MS): void {
    this.#process.send({ order: "command", command, valid_ms } satisfies Order);
  }

  async notes(): Promise<Notes> {
    this.#process.send({ order: "notes" } satisfies Order);
    const [notes] = await once(this.#process, "message");
    return notes as Notes;
  }

  /** The computer's lid is closed. */
  sleep(): void {
    this.#process.kill("SIGSTOP");
  }

  wake(): void {
    this.#process.kill("SIGCONT");
  }

  end(): void {
    this.#process.kill("SIGKILL");
  }
}

/** The program itself. */
export function beOperator(words: string): void {
  const desk = new Desk(JSON.parse(words) as Post);
  process.on("message", (order: Order) => {
    if (order.order === "command") desk.command(order.command, order.valid_ms);
    else process.send?.(desk.notes);
  });
  desk.dial();
}

class Desk {
  readonly #post: Post;
  readonly #events: [number, number][] = [];
  readonly #statuses: [number, number, boolean][] = [];
  readonly #given = new Map<string, Given>();
  readonly #open = new Map<string, Envelope>();
  #socket: WebSocket | null = null;
  #next = 1;
  #twice = 0;
  #count = 0;

  constructor(post: Post) {
    this.#post = post;
  }

  get notes(): Notes {
    const given = [...this.#given.values()];
    const shown = { events: this.#events, statuses: this.#statuses, given };
    return { ...shown, twice: this.#twice, receivedUpTo: this.#next - 1 };
  }

  /** Connects, again and again, and goes on where it was. */
  dial(): void {
    const { url, token, run } = this.#post;
    const headers = { authorization: `Bearer ${token}` };
    const socket = new WebSocket(`${url.replace("http", "ws")}/api/v1/socket`, { headers });
    socket.on("open", () => {
      this.#socket = socket;
      this.#subscribe(HISTORY, { topic: "run_history", run, from: this.#next, values: true });
      this.#subscribe(STATUS, { topic: "run_status", run });
      for (const envelope of this.#open.values()) this.#say({ frame: "command", run, envelope });
    });
    socket.on("message", (text) => this.#hear(JSON.parse(String(text)) as ToClient));
    socket.on("error", () => undefined);
    socket.on("close", () => {
      this.#socket = null;
      setTimeout(() => this.dial(), 200);
    });
  }

  #subscribe(subscription: number, topic: unknown): void {
    this.#say({ frame: "subscribe", subscription, topic });
  }

  #say(frame: unknown): void {
    this.#socket?.send(JSON.stringify(frame));
  }

  command(command: Command, valid_ms: number | null): void {
    this.#count += 1;
    const id = `${this.#post.name}-${this.#count}`;
    const sent_ms = Date.now();
    const expiry = valid_ms === null ? null : sent_ms + valid_ms;
    const envelope = { id, author: "", decided_on: this.#next - 1, expiry, command } as Envelope;
    const given = { id, type: command.type, sent_ms, expiry_ms: expiry };
    this.#given.set(id, { ...given, answered_ms: null, answer: null });
    this.#open.set(id, envelope);
    this.#say({ frame: "command", run: this.#post.run, envelope });
  }

  #hear(frame: ToClient): void {
    const now = Date.now();
    if (frame.frame === "events") {
      for (const { sequence } of frame.events) {
        if (sequence < this.#next) this.#twice += 1;
        else this.#events.push([sequence, now]);
        this.#next = Math.max(this.#next, sequence + 1);
      }
      this.#next = Math.max(this.#next, frame.next);
    } else if (frame.frame === "run_status") {
      const { snapshot } = frame.status;
      if (snapshot) this.#statuses.push([snapshot.sequence, now, snapshot.status === "paused"]);
    } else if (frame.frame === "ended" && frame.refusal) {
      // The station does not know the run yet.
      setTimeout(() => this.#socket?.close(), 200);
    } else if (frame.frame === "answer") {
      this.#answered(frame.id, frame.answer, now);
    } else if (frame.frame === "refused" && frame.id) {
      // Whether the robot has it is not known: the same id is asked about again.
      const again = ["link_lost", "no_answer"].includes(frame.refusal.code);
      if (again) setTimeout(() => this.#ask(frame.id ?? ""), 1_000);
      else this.#answered(frame.id, "refused", now);
    }
  }

  #ask(id: string): void {
    const envelope = this.#open.get(id);
    const isOver = envelope?.expiry != null && Date.now() > envelope.expiry + 60_000;
    if (isOver) this.#answered(id, "lost", Date.now());
    else if (envelope) this.#say({ frame: "command", run: this.#post.run, envelope });
  }

  #answered(id: string, answer: Answer["answer"] | "lost", now: number): void {
    this.#open.delete(id);
    const given = this.#given.get(id);
    if (given && given.answer === null) [given.answer, given.answered_ms] = [answer, now];
  }
}
