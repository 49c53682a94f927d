/** What went wrong in a run and wants a human: found while the journal grows, each event looked at once. An error that climbs
 * through the states around it is one failure; the same failure of the same state again counts, whatever comes between. */

import type { Event } from "../../model/generated/protocol.ts";
import { ABORTED } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";
import { LOSS_WORDS } from "../../model/run_words.ts";
import { shortValue } from "../../model/short_value.ts";
import { readTraceback, withoutModule } from "../../model/traceback.ts";
import { read } from "../../model/wire.ts";
import { ENTERED, type Journal, LEFT, OTHER } from "./journal.ts";

export interface RunFailure {
  /** Of the event that it is told by; of what happened several times, the newest. */
  readonly sequence: number;
  /** The same of the first time: by this it is known. */
  readonly first: number;
  readonly t_ns: number;
  /** `error`: it left an error with another outcome than *aborted*. */
  readonly kind: "aborted" | "error" | "log" | "deadline" | "lost-link" | "cut-off" | "crash";
  readonly level: "warning" | "error";
  /** The state; empty if it is about none. */
  readonly path: string;
  /** What is said about it. Of a state's end its error, else the last line of its traceback; empty if neither was told. */
  readonly text: string;
  /** The outermost state that the error has climbed to; else the state itself. */
  readonly reach: string;
  /** How often the same happened. */
  readonly count: number;
}

/** Capacity. Acknowledged failures are dropped first, then open ones, the oldest first. */
export const FAILURES_MAX = 1_000;
/** A script's traceback is logged so few events before its state ends by it. */
const TRACEBACK_NEAR = 5;

/** Numbers of failures dropped from the list. */
export interface DroppedFailures {
  /** Number of failures dropped before anybody acknowledged them. */
  readonly open: number;
  readonly all: number;
}

export class Failures {
  /** By state and cause, in the order in which they happened first. */
  readonly #all = new Map<string, RunFailure>();
  #list: readonly RunFailure[] = [];
  #next = 0;
  /** The sequence numbers of what was acknowledged, and the causes of those that are listed. */
  #acknowledged: ReadonlySet<number> = new Set();
  #settled = new Set<string>();
  #dropped: DroppedFailures = { open: 0, all: 0 };
  /** The newest by itself, its cause, and what stood there before it; null before anything went wrong. */
  #last: {
    readonly failure: RunFailure;
    readonly cause: string;
    readonly before: RunFailure | null;
  } | null = null;
  /** The state that an error has climbed to and may climb on from: nothing has run beside it since. */
  #climbing: string | null = null;

  /** Numbers of dropped failures; the same object while they are equal. */
  get dropped(): DroppedFailures {
    return this.#dropped;
  }

  /** All of them, in the order in which they happened first; the same object as before if there is nothing new. */
  found(journal: Journal, acknowledged: ReadonlySet<number> = new Set()): readonly RunFailure[] {
    if (acknowledged !== this.#acknowledged && this.#next < journal.length) {
      this.#acknowledged = acknowledged;
      const settled = [...this.#all].filter(([, { sequence }]) => acknowledged.has(sequence));
      this.#settled = new Set(settled.map(([cause]) => cause));
    }
    let isNew = false;
    for (; this.#next < journal.length; this.#next += 1) {
      if (this.#look(journal, this.#next)) isNew = true;
    }
    if (isNew) this.#list = [...this.#all.values()];
    return this.#list;
  }

  #look(journal: Journal, index: number): boolean {
    if (this.#climbing !== null && journal.kind(index) === ENTERED) {
      const path = journal.pathOf(journal.pathNumber(index));
      if (parentOf(path) === parentOf(this.#climbing)) this.#climbing = null;
    }
    const failure = at(journal, index);
    if (failure) this.#put(failure);
    return failure !== null;
  }

  /** Beside the one before, or as a part of it. */
  #put(failure: RunFailure): void {
    const last = this.#last;
    const joined = last && this.#together(last.failure, failure);
    if (isEnd(failure)) this.#climbing = failure.path;
    if (joined) {
      this.#set(last.cause, last.before);
    }
    this.#fold(joined ?? failure);
  }

  /** Counts it where the same happened before. */
  #fold(failure: RunFailure): void {
    const cause = causeOf(failure);
    const before = this.#all.get(cause) ?? null;
    const { first, count } = before ?? { first: failure.sequence, count: 0 };
    this.#set(cause, { ...failure, first, count: count + 1 });
    this.#last = { failure, cause, before };
    while (this.#all.size > FAILURES_MAX) this.#drop();
  }

  #set(cause: string, failure: RunFailure | null): void {
    if (failure) this.#all.set(cause, failure);
    else this.#all.delete(cause);
    if (failure && this.#acknowledged.has(failure.sequence)) this.#settled.add(cause);
    else this.#settled.delete(cause);
  }

  #drop(): void {
    const [settled] = this.#settled;
    const [oldest = ""] = this.#all.keys();
    this.#set(settled ?? oldest, null);
    const { open, all } = this.#dropped;
    this.#dropped = { open: settled === undefined ? open + 1 : open, all: all + 1 };
  }

  #together(before: RunFailure, failure: RunFailure): RunFailure | null {
    if (!isEnd(failure)) return null;
    if (isTracebackOf(before, failure)) {
      return { ...failure, text: failure.text || lastLine(before.text) };
    }
    const climbs = this.#climbing === before.reach && parentOf(before.reach) === failure.path;
    return isEnd(before) && climbs ? { ...before, reach: failure.path } : null;
  }
}

/** The same for what happened to the same state for the same reason. Numbers in a text are seldom a reason of their own. */
function causeOf({ kind, level, path, text }: RunFailure): string {
  return [kind, level, path, text.replace(/\d+([.,]\d+)?/g, "#")].join("\n");
}

/** Whether it is about a state that ended. */
export function isEnd({ kind }: RunFailure): boolean {
  return kind === "aborted" || kind === "error";
}

/** Whether a line of the log is about the same error. Of one that says itself what it is, only its traceback is. */
function isTracebackOf(
  { kind, level, path, sequence, text }: RunFailure,
  failure: RunFailure,
): boolean {
  const isNear = failure.sequence - sequence <= TRACEBACK_NEAR;
  const isAbout = failure.text === "" || readTraceback(text) !== null;
  return kind === "log" && level === "error" && path === failure.path && isNear && isAbout;
}

/** The last line of a text, such as a traceback. */
export function lastLine(text: string): string {
  return withoutModule(text.trimEnd().split("\n").at(-1) ?? "");
}

function at(journal: Journal, index: number): RunFailure | null {
  const [sequence, t_ns, kind] = [
    journal.sequence(index),
    journal.t_ns(index),
    journal.kind(index),
  ];
  if (kind === LEFT) {
    const about = ofEnd(journal, index);
    return about && { sequence, first: sequence, t_ns, ...about, reach: about.path, count: 1 };
  }
  const event = kind === OTHER ? journal.other(index) : undefined;
  const about = event && causeOfEvent(event);
  return about ? { sequence, first: sequence, t_ns, ...about, reach: about.path, count: 1 } : null;
}

type FailureCause = Pick<RunFailure, "kind" | "level" | "path" | "text">;

function ofEnd(journal: Journal, index: number): FailureCause | null {
  const isAborted = journal.outcome(index)?.id === ABORTED;
  if (journal.isBack(index) || !(isAborted || journal.hasError(index))) return null;
  const path = journal.pathOf(journal.pathNumber(index));
  const text = errorInWords(journal.error(index));
  return { kind: isAborted ? "aborted" : "error", level: "error", path, text };
}

/** What a state did that failed; empty of all else. */
export function didInWords(kind: RunFailure["kind"]): string {
  return kind === "aborted" ? "aborted" : kind === "error" ? "ended with an error" : "";
}

const ERROR_MAX = 400;

/** An error as it was told, in words; empty if nothing is known of it. */
export function errorInWords(error: unknown): string {
  const found = read(error);
  if (found.kind === "none" || (found.kind === "object" && found.of === "")) return "";
  return found.kind === "text" ? found.text : withoutModule(shortValue(error, ERROR_MAX));
}

/** Failure that an event reports; null if it reports none. */
export function causeOfEvent(event: Event): FailureCause | null {
  switch (event.type) {
    case "log": {
      const { level, path, message: text } = event;
      return level === "warning" || level === "error" ? { kind: "log", level, path, text } : null;
    }
    case "deadline_passed": {
      const text = `has run longer than its deadline of ${seconds(event.deadline_ms)}`;
      return { kind: "deadline", level: "warning", path: event.path, text };
    }
    case "loss_recovery": {
      const text = `gave way to its recovery: ${LOSS_WORDS[event.loss]}`;
      return { kind: "lost-link", level: "warning", path: event.path, text };
    }
    case "cut_off": {
      const text = `ignored its preemption and was cut off after ${seconds(event.grace_ms)}`;
      return { kind: "cut-off", level: "warning", path: event.path, text };
    }
    case "resumed": {
      const { crash, life } = event;
      const text = `The program of the run died (${crash.reason}). The run was resumed; this is life ${life}.`;
      return { kind: "crash", level: "error", path: "", text };
    }
    default:
      return null;
  }
}

function seconds(ms: number): string {
  return `${ms / 1_000} s`;
}
