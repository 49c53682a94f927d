/** What happened in a run, in columns of a few bytes an event: all of it, or a part with what is known from before it. Knows events;
 * never who tells them, nor how they are shown. */

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

/** What is kept of each event in columns. Whatever is none of the first two has its whole event beside. */
export const ENTERED = 0;
export const LEFT = 1;
export const OTHER = 2;

/** An entry or end of a state, or something else by its whole event. */
export type Happening =
  | {
      readonly kind: "entered" | "left";
      readonly sequence: number;
      readonly t_ns: number;
      readonly path: string;
      /** How it ended; of an entry null. */
      readonly outcome: Outcome | null;
      /** Whether it was a step back. */
      readonly isBack: boolean;
      /** Whether it left an error. */
      readonly hasError: boolean;
      /** The error in few words, as it was told; null also where it is too long ago to be here. */
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

/** Events that say which calls go on and by which machine the run goes: all of them are kept, whoever reads them and when. */
const STRUCTURAL: ReadonlySet<Event["type"]> = new Set(["resumed", "dropped", "root"]);

/** So many whole events are kept, the newest, and so many errors; older ones are asked for at the server. */
const OTHERS_MAX = 20_000;

/** What is known from before the first event of a part of a run. */
export interface JournalBase {
  /** What was active. */
  readonly before: Before;
  /** What states had done, and what was worth a mark; null while that is not known. */
  readonly earlier: EarlierHistory | null;
}

export class Journal {
  /** Null if it begins with the run. */
  readonly base: JournalBase | null;
  /** The index of its first event. Before it stand single events from earlier: entries of what was active, and what was worth a mark. */
  readonly first: number;
  readonly #sequence = new NumberColumn(Float64Array);
  readonly #t_ns = new NumberColumn(Float64Array);
  readonly #kind = new NumberColumn(Uint8Array);
  readonly #flags = new NumberColumn(Uint8Array);
  /** The number of the path; of other events that of no path. */
  readonly #path = new NumberColumn(Int32Array);
  /** The number of the outcome. */
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
  /** How often and how long states ran. */
  readonly counts = new Counts();

  constructor(base: JournalBase | null = null) {
    this.base = base;
    if (base) this.#begin(base);
    this.first = this.#sequence.length;
  }

  /** How many events are here, with those from earlier. */
  get length(): number {
    return this.#sequence.length;
  }

  /** Every event from this number on was told. */
  get from(): number {
    return (this.base?.before.sequence ?? 0) + 1;
  }

  /** Whether it is known how often states had run: of a part that comes a little later. */
  get hasCounts(): boolean {
    return this.base === null || this.base.earlier !== null;
  }

  /** Whether what happened around this event is here. */
  covers(sequence: number): boolean {
    return sequence >= this.from && sequence < this.#next;
  }

  /** The cursor: everything before was told. */
  get next(): number {
    return this.#next;
  }

  /** Takes what was told. What was told before is left out: nothing is here twice. */
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

  /** The state of an entry or end, by its number. */
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

  /** The error that a state left, in few words, as it was told; null also where it is too long ago to be here. */
  error(index: number): JsonValue {
    return this.#errors.get(this.sequence(index)) ?? null;
  }

  /** Another event than an entry or end; undefined also where it is too long ago to be here. */
  other(index: number): Event | undefined {
    const sequence = this.sequence(index);
    return this.#others.get(sequence) ?? this.#structural.get(sequence);
  }

  /** All other events that are here, the oldest first, with their sequence numbers. */
  others(): readonly (readonly [number, Event])[] {
    const all = [...this.#others, ...this.#structural];
    return all.sort(([one], [other]) => one - other);
  }

  /** The event with all that is here of it; undefined beyond the end, and of another event that is too long ago. */
  at(index: number): Happening | undefined {
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

  /** The index of the first event from a number on; `length` if there is none. */
  indexOf(sequence: number): number {
    return this.#sequence.firstFrom(sequence);
  }

  /** The index of the first event from a time on; `length` if there is none. */
  indexAt(t_ns: number): number {
    return this.#t_ns.firstFrom(t_ns);
  }

  /** When an event happened; null if it is not here. */
  timeOf(sequence: number): number | null {
    const index = this.indexOf(sequence);
    return this.sequence(index) === sequence ? this.t_ns(index) : null;
  }

  /** Whether no crash stopped the run's clock before this time: then the time of the day is known, too. */
  hasClockAt(t_ns: number): boolean {
    return t_ns < this.#resumed_ns;
  }

  /** Begins with what is known from before. */
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
      // Those around it first: what is told from earlier may begin anywhere.
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

/** The oldest makes room. */
function keep<T>(all: Map<number, T>, sequence: number, what: T): void {
  all.set(sequence, what);
  if (all.size <= OTHERS_MAX) return;
  for (const oldest of all.keys()) {
    all.delete(oldest);
    return;
  }
}
