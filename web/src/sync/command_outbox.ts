/** The commands that this page sends to a run: each is sent again under its id until its fate is known, by the server's answer or
 * by the run's own history. Knows nothing of what they do. */

import { signal } from "@preact/signals-core";
import type { Answer, Command, CommandAnswer, Event } from "../model/generated/protocol.ts";
import type { SentCommand } from "../store/history/run.ts";
import { REPEATED, RefusalError, type Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";

export interface CommandOutboxPorts {
  readonly server: Server;
  readonly clock: Clock;
  readonly newId: () => string;
  /** Where they go. */
  readonly path: string;
  /** The last event that was told. */
  readonly decidedOn: () => number;
}

type Fate = NonNullable<SentCommand["answer"]>;

/** A command is no longer wanted after so long, if nobody says otherwise; as `Command::lifetime_ms` in the protocol says. */
const PATIENCE_MS = 10_000;
/** What only brings a run to its end is wanted whenever it arrives. */
const LASTING: readonly Command["type"][] = ["stop", "kill"];
/** A command without an answer is asked for again after so long. */
const AGAIN_MS = 500;
/** So long after its expiry its fate is asked for. Then it is lost. */
const FATE_MS = 600_000;
/** So many answered commands are kept. */
const SENT_MAX = 50;

export class CommandOutbox {
  readonly sent = signal<readonly SentCommand[]>([]);
  readonly #ports: CommandOutboxPorts;
  /** Those whose fate is not known yet. */
  readonly #open = new Map<string, (fate: Fate) => void>();
  #isOver = false;

  constructor(ports: CommandOutboxPorts) {
    this.#ports = ports;
  }

  async send(command: Command, patience_ms = PATIENCE_MS): Promise<SentCommand> {
    const { clock, newId, server, decidedOn } = this.#ports;
    const [id, sent_ms] = [newId(), clock.now()];
    const isLasting = LASTING.includes(command.type);
    const expiry_ms = isLasting ? Number.POSITIVE_INFINITY : sent_ms + patience_ms;
    const ahead_ms = server.pulse.peek()?.ahead_ms ?? 0;
    const expiry = isLasting ? null : Math.round(expiry_ms + ahead_ms);
    const begun: SentCommand = { id, command, sent_ms, expiry_ms, answer: null, answered_ms: null };
    this.#put(begun);
    const recorded = new Promise<Fate>((known) => this.#open.set(id, known));
    const body = { id, author: "", decided_on: decidedOn(), expiry, command };
    const answer = await Promise.race([recorded, this.#answered(body, expiry_ms)]);
    this.#open.delete(id);
    const sent = { ...begun, answer, answered_ms: clock.now() };
    this.#put(sent);
    return sent;
  }

  /** The history tells what became of commands, whoever sent them. */
  received(event: Event): void {
    if (event.type !== "commanded") return;
    // There ids are their author's: `anna/17`.
    const id = event.envelope.id.slice(event.envelope.id.indexOf("/") + 1);
    this.#open.get(id)?.(event.answer);
    const before = this.sent.peek().find((each) => each.id === id);
    if (before?.answer?.answer !== "lost") return;
    this.#put({ ...before, answer: event.answer, answered_ms: this.#ports.clock.now() });
  }

  close(): void {
    this.#isOver = true;
  }

  async #answered(body: { readonly id: string }, expiry_ms: number): Promise<Fate> {
    let isUncertain = false;
    for (;;) {
      try {
        return await this.#ask(body);
      } catch (error) {
        if (!(error instanceof RefusalError)) throw error;
        const { status, message } = error;
        const isForNow = status === 0 || status === 429 || status >= 500;
        if (!isForNow) return isUncertain ? lost(message) : { answer: "refused", reason: message };
        isUncertain ||= status !== 429;
        const isLate = this.#ports.clock.now() > expiry_ms + FATE_MS;
        if (isLate || this.#isOver || !this.#open.has(body.id)) return lost(message);
        await new Promise<void>((over) => this.#ports.clock.after(AGAIN_MS, over));
      }
    }
  }

  async #ask(body: { readonly id: string }): Promise<Answer> {
    const { server, path } = this.#ports;
    const { id: _, ...answer } = await server.request<CommandAnswer>("POST", path, body, REPEATED);
    return answer;
  }

  #put(sent: SentCommand): void {
    const before = this.sent.peek();
    const at = before.findIndex(({ id }) => id === sent.id);
    const all = at < 0 ? [...before, sent] : before.with(at, sent);
    const surplus = all.length - SENT_MAX;
    this.sent.value = all.filter(({ answer }, index) => answer === null || index >= surplus);
  }
}

function lost(reason: string): Fate {
  return { answer: "lost", reason };
}
