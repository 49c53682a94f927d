/** Failures of a run that need a person, collected as the journal grows; each event is read once. An error that propagates to outer
 * states is one failure. A repeated failure of a state is counted, even with others in between. */

import type { Event } from "../../model/generated/protocol.ts";
import { ABORTED } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";
import { LOSS_WORDS } from "../../model/run_words.ts";
import { shortValue } from "../../model/short_value.ts";
import { readTraceback, withoutModule } from "../../model/traceback.ts";
import { read } from "../../model/wire.ts";
import { ENTERED, type Journal, LEFT, OTHER } from "./journal.ts";

export interface RunFailure {
  /** Sequence number of the event that reports it; of repeated failures, the latest. */
  readonly sequence: number;
  /** Sequence number of the first occurrence. It identifies the failure. */
  readonly first: number;
  readonly t_ns: number;
  /** `error`: the state left an error with an outcome other than *aborted*. */
  readonly kind: "aborted" | "error" | "log" | "deadline" | "lost-link" | "cut-off" | "crash";
  readonly level: "warning" | "error";
  /** Path of the state; empty if no state is involved. */
  readonly path: string;
  /** Description. For the end of a state, its error or the last line of its traceback; empty if neither is known. */
  readonly text: string;
  /** Outermost state that the error has reached; otherwise the state itself. */
  readonly reach: string;
  /** Number of occurrences. */
  readonly count: number;
}

/** Capacity. Acknowledged failures are dropped before open ones, and older before newer ones. */
export const FAILURES_MAX = 1_000;
/** Greatest number of events from the traceback of a script to the end of its state. */
const TRACEBACK_NEAR = 5;

/** Numbers of failures dropped from the list. */
export interface DroppedFailures {
  /** Number of failures that were dropped before anybody acknowledged them. */
  readonly open: number;
  readonly all: number;
}

export class Failures {
  /** By state and cause, in the order of their first occurrence. */
  readonly #all = new Map<string, RunFailure>();
  #list: readonly RunFailure[] = [];
  #next = 0;
  /** Acknowledged sequence numbers, and the causes of acknowledged failures in the list. */
  #acknowledged: ReadonlySet<number> = new Set();
  #settled = new Set<string>();
  #dropped: DroppedFailures = { open: 0, all: 0 };
  /** The latest failure alone, its cause, and the earlier failure of that cause; null before the first failure. */
  #last: {
    readonly failure: RunFailure;
    readonly cause: string;
    readonly before: RunFailure | null;
  } | null = null;
  /** State that an error has reached and may propagate from. Null after a sibling of it was entered. */
  #climbing: string | null = null;

  /** Numbers of dropped failures; a new object after each change. */
  get dropped(): DroppedFailures {
    return this.#dropped;
  }

  /** All failures in the order of their first occurrence; a new list after each change. */
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

  /** Adds a failure, or joins it with the previous one. */
  #put(failure: RunFailure): void {
    const last = this.#last;
    const joined = last && this.#together(last.failure, failure);
    if (isEnd(failure)) this.#climbing = failure.path;
    if (joined) {
      this.#set(last.cause, last.before);
    }
    this.#fold(joined ?? failure);
  }

  /** Counts the failure under its cause. */
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

/** Key of a failure's state and reason. Numbers in the text are replaced, because they seldom make another reason. */
function causeOf({ kind, level, path, text }: RunFailure): string {
  return [kind, level, path, text.replace(/\d+([.,]\d+)?/g, "#")].join("\n");
}

/** True for failures that ended a state. */
export function isEnd({ kind }: RunFailure): boolean {
  return kind === "aborted" || kind === "error";
}

/** True if a log line describes this failure. If the failure has its own text, only a traceback qualifies. */
function isTracebackOf(
  { kind, level, path, sequence, text }: RunFailure,
  failure: RunFailure,
): boolean {
  const isNear = failure.sequence - sequence <= TRACEBACK_NEAR;
  const isAbout = failure.text === "" || readTraceback(text) !== null;
  return kind === "log" && level === "error" && path === failure.path && isNear && isAbout;
}

/** Last line of a text such as a traceback. */
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

/** Verb for the state of a failure; empty for other failures. */
export function didInWords(kind: RunFailure["kind"]): string {
  return kind === "aborted" ? "aborted" : kind === "error" ? "ended with an error" : "";
}

const ERROR_MAX = 400;

/** Text of an error; empty if nothing is known of it. */
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
