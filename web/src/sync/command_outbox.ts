/** The commands that this page sends to a run: each is sent again under its id until its fate is known, by the server's answer or
 * by the run's own history. Knows nothing of what they do. */

import { signal } from "@preact/signals-core";
import { waitForContact_ms } from "../model/contact_wait.ts";
import type {
  Command,
  CommandAnswer,
  Envelope,
  Event,
  LinkHealth,
} from "../model/generated/protocol.ts";
import type { SentCommand } from "../store/history/run.ts";
import { REPEATED, type Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";
import { AGAIN, LATER, Outbox } from "./outbox.ts";

export interface CommandOutboxPorts {
  readonly server: Server;
  readonly clock: Clock;
  readonly newId: () => string;
  /** Path of the requests. */
  readonly path: string;
  /** Last received event. */
  readonly decidedOn: () => number;
  /** Lifetime over the link to the run of a command with this length in bytes, at this time of the server; null without a link. */
  readonly linkLifetime_ms?: (bytes: number, server_ms: number) => number | null;
}

type Fate = NonNullable<SentCommand["answer"]>;

interface CommandOnItsWay {
  readonly id: string;
  readonly body: Envelope;
  /** When nobody asks for its fate any more. */
  readonly end_ms: number;
  /** True if an answer may have been lost. */
  isUncertain: boolean;
}

/** Lifetime of a command without a link, equal to `Command::lifetime_ms` of the protocol. */
const PATIENCE_MS = 10_000;
/** A stop is wanted whenever it arrives. */
const LASTING: readonly Command["type"][] = ["stop", "kill"];
/** Time after the expiry in which the fate is requested, in ms. Later the command counts as lost. */
const FATE_MS = 600_000;
/** Capacity of the answered commands. */
const SENT_MAX = 50;

/** As `LinkLifetime` in the protocol: the time to send a command is added twice, for parts that are lost, and a lifetime counts from
 * the begin of the next planned contact if none is open. */
export function lifetimeOverLink_ms(
  link: LinkHealth | null | undefined,
  bytes: number,
  server_ms: number,
): number | null {
  if (!link || link.lifetime_ms === null) return null;
  const rate = link.command_bytes_per_s;
  const wait_ms = waitForContact_ms(link, server_ms);
  return wait_ms + link.lifetime_ms + (rate === null ? 0 : (2_000 * bytes) / Math.max(1, rate));
}

export class CommandOutbox {
  readonly sent = signal<readonly SentCommand[]>([]);
  readonly #ports: CommandOutboxPorts;
  readonly #outbox: Outbox<CommandOnItsWay, CommandAnswer, Fate>;
  #isOver = false;

  constructor(ports: CommandOutboxPorts) {
    this.#ports = ports;
    const { clock, server, path } = ports;
    this.#outbox = new Outbox<CommandOnItsWay, CommandAnswer, Fate>({
      clock,
      send: ({ body }) => server.request("POST", path, body, REPEATED),
      onAnswer: (command, { id: _, ...answer }) => {
        if (answer.answer !== "unknown") return answer;
        // A station asks the robot until it knows, and is asked here as long.
        const isLate = this.#isOver || clock.now() > command.end_ms;
        return isLate ? { answer: "lost", reason: answer.reason } : LATER;
      },
      onRefusal: (command, { status, message, isForNow }) => {
        if (isForNow && status !== 429) command.isUncertain = true;
        const isLate = this.#isOver || clock.now() > command.end_ms;
        if (isForNow && !isLate) return AGAIN;
        const isLost = isForNow || command.isUncertain;
        return { answer: isLost ? "lost" : "refused", reason: message };
      },
    });
  }

  async send(command: Command, wanted_ms?: number): Promise<SentCommand> {
    const { clock, newId, server, decidedOn, linkLifetime_ms } = this.#ports;
    const bytes = new TextEncoder().encode(JSON.stringify(command)).length;
    const [id, sent_ms] = [newId(), clock.now()];
    const ahead_ms = server.pulse.peek()?.ahead_ms ?? 0;
    const patience_ms = wanted_ms ?? linkLifetime_ms?.(bytes, sent_ms + ahead_ms) ?? PATIENCE_MS;
    const isLasting = LASTING.includes(command.type);
    const expiry_ms = isLasting ? Number.POSITIVE_INFINITY : sent_ms + patience_ms;
    const expiry = isLasting ? null : Math.round(expiry_ms + ahead_ms);
    const begun: SentCommand = { id, command, sent_ms, expiry_ms, answer: null, answered_ms: null };
    this.#put(begun);
    const body = { id, author: "", decided_on: decidedOn(), expiry, command };
    const end_ms = expiry_ms + FATE_MS;
    const answer = await this.#outbox.put({ id, body, end_ms, isUncertain: false });
    const sent = { ...begun, answer, answered_ms: clock.now() };
    this.#put(sent);
    return sent;
  }

  /** The history contains the fates of all commands of all users. */
  received(event: Event): void {
    if (event.type !== "commanded") return;
    // There ids are their author's: `anna/17`.
    const id = event.envelope.id.slice(event.envelope.id.indexOf("/") + 1);
    if (event.answer.answer === "unknown") return;
    this.#outbox.settle(id, event.answer);
    const before = this.sent.peek().find((each) => each.id === id);
    if (before?.answer?.answer !== "lost") return;
    this.#put({ ...before, answer: event.answer, answered_ms: this.#ports.clock.now() });
  }

  close(): void {
    this.#isOver = true;
  }

  #put(sent: SentCommand): void {
    const before = this.sent.peek();
    const at = before.findIndex(({ id }) => id === sent.id);
    const all = at < 0 ? [...before, sent] : before.with(at, sent);
    const surplus = all.length - SENT_MAX;
    this.sent.value = all.filter(({ answer }, index) => answer === null || index >= surplus);
  }
}
