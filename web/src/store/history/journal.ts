/** Events of a run in columns of a few bytes per event: all of them, or a part with a summary of the earlier ones. Knows events;
 * never their source or display. */

import type {
  Before,
  EarlierHistory,
  Event,
  HistoryEntry,
  JsonValue,
  Outcome,
} from "../../model/generated/protocol.ts";
import { parentOf } from "../../model/path.ts";
import { NumberColumn } from "./column.ts";
import { Counts } from "./counts.ts";

/** Kind of an event. Events of kind `OTHER` are kept whole, too. */
export const ENTERED = 0;
export const LEFT = 1;
export const OTHER = 2;

/** An entry or end of a state, or another event as a whole. */
export type JournalEntry =
  | {
      readonly kind: "entered" | "left";
      readonly sequence: number;
      readonly t_ns: number;
      readonly path: string;
      /** Outcome of an end; null for an entry. */
      readonly outcome: Outcome | null;
      /** True for a step back. */
      readonly isBack: boolean;
      /** True if the state left an error. */
      readonly hasError: boolean;
      /** Short form of the error, as it was received; null also if it was dropped. */
      readonly error: JsonValue;
    }
  | {
      readonly kind: "other";
      readonly sequence: number;
      readonly t_ns: number;
      readonly event: Event;
    };

const BACK = 1;
const ERROR = 2;
const NO_OUTCOME = 0;

/** Events that determine which calls are open and which machine the run uses. All of them are kept. */
const STRUCTURAL: ReadonlySet<Event["type"]> = new Set(["resumed", "dropped", "root"]);

/** Capacity of whole events, and of errors. Older ones must be requested from the server. */
const OTHERS_MAX = 20_000;

/** State of a run before the first event of a part. */
export interface JournalBase {
  /** Active states. */
  readonly before: Before;
  /** Counts of states, and notable events; null until they are known. */
  readonly earlier: EarlierHistory | null;
}

export class Journal {
  /** Null if the journal starts with the run. */
  readonly base: JournalBase | null;
  /** Index of the first event. Before it are single earlier events: entries of active states, and notable events. */
  readonly first: number;
  readonly #sequence = new NumberColumn(Float64Array);
  readonly #t_ns = new NumberColumn(Float64Array);
  readonly #kind = new NumberColumn(Uint8Array);
  readonly #flags = new NumberColumn(Uint8Array);
  /** Number of the path; -1 for other events. */
  readonly #path = new NumberColumn(Int32Array);
  /** Number of the outcome; 0 for none. */
  readonly #outcome = new NumberColumn(Int32Array);
  readonly #paths: string[] = [];
  readonly #numbers = new Map<string, number>();
  readonly #outcomes: (Outcome | null)[] = [null];
  readonly #outcomeNumbers = new Map<string, number>();
  readonly #others = new Map<number, Event>();
  readonly #structural = new Map<number, Event>();
  readonly #errors = new Map<number, JsonValue>();
  #next = 1;
  #resumed_ns = Number.POSITIVE_INFINITY;
  /** Counts and durations of states. */
  readonly counts = new Counts();

  constructor(base: JournalBase | null = null) {
    this.base = base;
    if (base) this.#begin(base);
    this.first = this.#sequence.length;
  }

  /** Number of events, including single earlier ones. */
  get length(): number {
    return this.#sequence.length;
  }

  /** Sequence number from which on all events were received. */
  get from(): number {
    return (this.base?.before.sequence ?? 0) + 1;
  }

  /** True if the counts are known. For a part they arrive a little later. */
  get hasCounts(): boolean {
    return this.base === null || this.base.earlier !== null;
  }

  /** True if the events around this one are in the journal. */
  covers(sequence: number): boolean {
    return sequence >= this.from && sequence < this.#next;
  }

  /** Cursor: all events before it were received. */
  get next(): number {
    return this.#next;
  }

  /** Adds received events, except those received before. */
  add(entries: readonly HistoryEntry[], next: number): void {
    for (const entry of entries) {
      if (entry.sequence < this.#next) continue;
      this.#add(entry);
      this.#next = entry.sequence + 1;
    }
    this.#next = Math.max(this.#next, next);
  }

  sequence(index: number): number {
    return this.#sequence.at(index);
  }

  t_ns(index: number): number {
    return this.#t_ns.at(index);
  }

  /** `ENTERED`, `LEFT` or `OTHER`. */
  kind(index: number): number {
    return this.#kind.at(index);
  }

  /** Number of the path of an entry or end. */
  pathNumber(index: number): number {
    return this.#path.at(index);
  }

  pathOf(number: number): string {
    return this.#paths[number] ?? "";
  }

  outcome(index: number): Outcome | null {
    return this.#outcomes[this.#outcome.at(index)] ?? null;
  }

  isBack(index: number): boolean {
    return (this.#flags.at(index) & BACK) !== 0;
  }

  hasError(index: number): boolean {
    return (this.#flags.at(index) & ERROR) !== 0;
  }

  /** Short form of the error of an end, as it was received; null also if it was dropped. */
  error(index: number): JsonValue {
    return this.#errors.get(this.sequence(index)) ?? null;
  }

  /** An event other than an entry or end; undefined also if it was dropped. */
  other(index: number): Event | undefined {
    const sequence = this.sequence(index);
    return this.#others.get(sequence) ?? this.#structural.get(sequence);
  }

  /** All kept events other than entries and ends, with their sequence numbers, the oldest first. */
  others(): readonly (readonly [number, Event])[] {
    const all = [...this.#others, ...this.#structural];
    return all.sort(([one], [other]) => one - other);
  }

  /** The event with all its kept data; undefined beyond the end, and for dropped events. */
  at(index: number): JournalEntry | undefined {
    if (index < 0 || index >= this.length) return undefined;
    const [sequence, t_ns, kind] = [this.sequence(index), this.t_ns(index), this.kind(index)];
    if (kind === OTHER) {
      const event = this.other(index);
      return event && { kind: "other", sequence, t_ns, event };
    }
    return {
      kind: kind === ENTERED ? "entered" : "left",
      sequence,
      t_ns,
      path: this.pathOf(this.pathNumber(index)),
      outcome: this.outcome(index),
      isBack: this.isBack(index),
      hasError: this.hasError(index),
      error: this.error(index),
    };
  }

  /** Index of the first event from a sequence number on; `length` if none. */
  indexOf(sequence: number): number {
    return this.#sequence.firstFrom(sequence);
  }

  /** Index of the first event from a time on; `length` if none. */
  indexAt(t_ns: number): number {
    return this.#t_ns.firstFrom(t_ns);
  }

  /** Time of an event; null if it is not in the journal. */
  timeOf(sequence: number): number | null {
    const index = this.indexOf(sequence);
    return this.sequence(index) === sequence ? this.t_ns(index) : null;
  }

  /** True if no crash stopped the run's clock before this time. Only then the time of day is known. */
  hasClockAt(t_ns: number): boolean {
    return t_ns < this.#resumed_ns;
  }

  /** Adds the state before the first event. */
  #begin({ before, earlier }: JournalBase): void {
    const entries = before.active.map(
      ({ path, sequence, t_ns }): HistoryEntry => ({
        sequence,
        t_ns,
        event: { type: "entered", path },
      }),
    );
    const all = [...entries, ...(earlier?.notable ?? [])];
    for (const entry of all.sort((one, other) => one.sequence - other.sequence)) this.#put(entry);
    for (const state of earlier?.states ?? []) {
      this.counts.begin(this.#numberOf(state.path), state);
    }
    for (const { path, t_ns } of before.active) {
      this.counts.active(this.#numberOf(path), path, t_ns);
    }
    this.#next = before.sequence + 1;
  }

  #add(entry: HistoryEntry): void {
    const { t_ns, event } = entry;
    this.#put(entry);
    if (event.type === "entered") {
      this.counts.entered(this.#numberOf(event.path), event.path, t_ns, event.undoes != null);
    } else if (event.type === "left") {
      const { path, outcome, undoes } = event;
      this.counts.left(this.#numberOf(path), path, t_ns, outcome, undoes != null);
    }
  }

  #put({ sequence, t_ns, event }: HistoryEntry): void {
    this.#sequence.push(sequence);
    this.#t_ns.push(t_ns);
    if (event.type === "resumed") this.#resumed_ns = Math.min(this.#resumed_ns, t_ns);
    if (event.type !== "entered" && event.type !== "left") {
      this.#push(OTHER, -1, NO_OUTCOME, 0);
      if (STRUCTURAL.has(event.type)) this.#structural.set(sequence, event);
      else keep(this.#others, sequence, event);
      return;
    }
    const isBack = event.undoes != null;
    const path = this.#numberOf(event.path);
    if (event.type === "entered") {
      this.#push(ENTERED, path, NO_OUTCOME, isBack ? BACK : 0);
      return;
    }
    const flags = (isBack ? BACK : 0) | (event.error != null ? ERROR : 0);
    if (event.error != null) keep(this.#errors, sequence, event.error as JsonValue);
    this.#push(LEFT, path, this.#outcomeNumber(event.outcome), flags);
  }

  #push(kind: number, path: number, outcome: number, flags: number): void {
    this.#kind.push(kind);
    this.#path.push(path);
    this.#outcome.push(outcome);
    this.#flags.push(flags);
  }

  #numberOf(path: string): number {
    let number = this.#numbers.get(path);
    if (number === undefined) {
      // Parent paths first, because earlier events may begin anywhere.
      const around = this.base === null ? null : parentOf(path);
      if (around !== null) this.#numberOf(around);
      number = this.#paths.push(path) - 1;
      this.#numbers.set(path, number);
    }
    return number;
  }

  #outcomeNumber(outcome: Outcome): number {
    const key = `${outcome.id} ${outcome.name}`;
    let number = this.#outcomeNumbers.get(key);
    if (number === undefined) {
      number = this.#outcomes.push(outcome) - 1;
      this.#outcomeNumbers.set(key, number);
    }
    return number;
  }
}

/** Adds an entry and drops the oldest one beyond the capacity. */
function keep<T>(all: Map<number, T>, sequence: number, what: T): void {
  all.set(sequence, what);
  if (all.size <= OTHERS_MAX) return;
  for (const oldest of all.keys()) {
    all.delete(oldest);
    return;
  }
}
