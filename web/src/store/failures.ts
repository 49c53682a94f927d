/** What went wrong in a run and wants a human: found while the journal grows, each event looked at once. An error that climbs
 * through the states around it is one failure; the same warning again counts. */

import type { Event } from "../model/generated/protocol.ts";
import { ABORTED } from "../model/machine.ts";
import { parentOf } from "../model/path.ts";
import { shortValue } from "../model/short_value.ts";
import { readTraceback, withoutModule } from "../model/traceback.ts";
import { read } from "../model/wire.ts";
import { ENTERED, type Journal, LEFT, OTHER } from "./journal.ts";

export interface Failure {
  /** Of the event that it is told by; of what happened several times, the newest. */
  readonly sequence: number;
  readonly t_ns: number;
  /** `error`: it left an error with another outcome than *aborted*. */
  readonly kind: "aborted" | "error" | "log" | "deadline" | "cut-off" | "crash";
  readonly level: "warning" | "error";
  /** The state; empty if it is about none. */
  readonly path: string;
  /** What is said about it. Of a state's end its error, else the last line of its traceback; empty if neither was told. */
  readonly text: string;
  /** The outermost state that the error has climbed to; else the state itself. */
  readonly reach: string;
  /** How often the same happened in a row. */
  readonly count: number;
}

/** So many are kept, the newest. */
export const FAILURES_MAX = 1_000;
/** A script's traceback is logged so few events before its state ends by it. */
const TRACEBACK_NEAR = 5;

export class Failures {
  #all: readonly Failure[] = [];
  #next = 0;
  /** The state that an error has climbed to and may climb on from: nothing has run beside it since. */
  #climbing: string | null = null;

  /** All of them, the oldest first; the same object as before if there is nothing new. */
  found(journal: Journal): readonly Failure[] {
    const fresh: Failure[] = [];
    for (; this.#next < journal.length; this.#next += 1) {
      this.#look(journal, this.#next, fresh);
    }
    if (fresh.length > 0) this.#all = [...this.#all, ...fresh].slice(-FAILURES_MAX);
    return this.#all;
  }

  #look(journal: Journal, index: number, fresh: Failure[]): void {
    if (this.#climbing !== null && journal.kind(index) === ENTERED) {
      const path = journal.pathOf(journal.pathNumber(index));
      if (parentOf(path) === parentOf(this.#climbing)) this.#climbing = null;
    }
    const failure = at(journal, index);
    if (failure) this.#put(fresh, failure);
  }

  /** Beside the one before, or as a part of it. */
  #put(fresh: Failure[], failure: Failure): void {
    const before = fresh.at(-1) ?? this.#all.at(-1);
    const joined = before && this.#together(before, failure);
    if (isEnd(failure)) this.#climbing = failure.path;
    if (!joined) {
      fresh.push(failure);
      return;
    }
    if (fresh.length > 0) fresh.pop();
    else this.#all = this.#all.slice(0, -1);
    fresh.push(joined);
  }

  #together(before: Failure, failure: Failure): Failure | null {
    const { kind, path, text, sequence, t_ns } = failure;
    if (isEnd(failure) && isTracebackOf(before, failure)) {
      return { ...failure, text: text || lastLine(before.text) };
    }
    if (isEnd(failure)) {
      const climbs = this.#climbing === before.reach && parentOf(before.reach) === path;
      return isEnd(before) && climbs ? { ...before, reach: path } : null;
    }
    if (kind !== before.kind) return null;
    const isSame = path === before.path && text === before.text;
    return isSame ? { ...before, sequence, t_ns, count: before.count + 1 } : null;
  }
}

/** Whether it is about a state that ended. */
export function isEnd({ kind }: Failure): boolean {
  return kind === "aborted" || kind === "error";
}

/** Whether a line of the log is about the same error. Of one that says itself what it is, only its traceback is. */
function isTracebackOf({ kind, level, path, sequence, text }: Failure, failure: Failure): boolean {
  const isNear = failure.sequence - sequence <= TRACEBACK_NEAR;
  const isAbout = failure.text === "" || readTraceback(text) !== null;
  return kind === "log" && level === "error" && path === failure.path && isNear && isAbout;
}

function lastLine(text: string): string {
  return withoutModule(text.trimEnd().split("\n").at(-1) ?? "");
}

function at(journal: Journal, index: number): Failure | null {
  const [sequence, t_ns, kind] = [
    journal.sequence(index),
    journal.t_ns(index),
    journal.kind(index),
  ];
  if (kind === LEFT) {
    const about = ofEnd(journal, index);
    return about && { sequence, t_ns, ...about, reach: about.path, count: 1 };
  }
  const event = kind === OTHER ? journal.other(index) : undefined;
  const about = event && ofEvent(event);
  return about ? { sequence, t_ns, ...about, reach: about.path, count: 1 } : null;
}

type About = Pick<Failure, "kind" | "level" | "path" | "text">;

function ofEnd(journal: Journal, index: number): About | null {
  const isAborted = journal.outcome(index)?.id === ABORTED;
  if (journal.isBack(index) || !(isAborted || journal.hasError(index))) return null;
  const path = journal.pathOf(journal.pathNumber(index));
  const text = errorInWords(journal.error(index));
  return { kind: isAborted ? "aborted" : "error", level: "error", path, text };
}

/** What a state did that failed; empty of all else. */
export function didInWords(kind: Failure["kind"]): string {
  return kind === "aborted" ? "aborted" : kind === "error" ? "ended with an error" : "";
}

const ERROR_MAX = 400;

/** An error as it was told, in words; empty if nothing is known of it. */
export function errorInWords(error: unknown): string {
  const found = read(error);
  if (found.kind === "none" || (found.kind === "object" && found.of === "")) return "";
  return found.kind === "text" ? found.text : withoutModule(shortValue(error, ERROR_MAX));
}

function ofEvent(event: Event): About | null {
  switch (event.type) {
    case "log": {
      const { level, path, message: text } = event;
      return level === "warning" || level === "error" ? { kind: "log", level, path, text } : null;
    }
    case "deadline_passed": {
      const text = `has run for longer than its ${seconds(event.deadline_ms)}`;
      return { kind: "deadline", level: "warning", path: event.path, text };
    }
    case "cut_off": {
      const text = `did not heed that it was preempted, and was cut off after ${seconds(event.grace_ms)}`;
      return { kind: "cut-off", level: "warning", path: event.path, text };
    }
    case "resumed": {
      const { crash, life } = event;
      const text = `The program of the run died (${crash.reason}). It was taken up; this is life ${life}.`;
      return { kind: "crash", level: "error", path: "", text };
    }
    default:
      return null;
  }
}

function seconds(ms: number): string {
  return `${ms / 1_000} s`;
}
