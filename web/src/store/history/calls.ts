/** Calls of a run: each entry of a state with its end, nested in the order of events. The journal is read as it grows, each event
 * once. Independent of their display. */

import type { Outcome } from "../../model/generated/protocol.ts";
import { parentOf } from "../../model/path.ts";
import { perOwner } from "../../model/per_owner.ts";
import { NumberColumn } from "./column.ts";
import { ENTERED, type Journal, LEFT } from "./journal.ts";

/** The call has not ended. */
export const OPEN = 0;
/** The call ended with an outcome. */
const ENDED = 1;
/** The call was left backwards by a step back. */
export const TAKEN_BACK = 2;
/** The call ended without an outcome: the run went back, or its runner died. */
export const DROPPED = 3;

/** Marks a missing call or event. */
export const NONE = -1;

const NO_CALLS: readonly number[] = [];

export class Calls {
  readonly journal: Journal;
  readonly #begin = new NumberColumn(Int32Array);
  readonly #end = new NumberColumn(Int32Array);
  readonly #how = new NumberColumn(Uint8Array);
  readonly #path = new NumberColumn(Int32Array);
  readonly #parent = new NumberColumn(Int32Array);
  readonly #depth = new NumberColumn(Int32Array);
  /** Calls inside each call, in order. */
  readonly #inside = new Map<number, number[]>();
  readonly #roots: number[] = [];
  /** Open call of each active state, by the number of its path. */
  readonly #open = new Map<number, number>();
  readonly #ofPath = new Map<number, number[]>();
  readonly #numbers = new Map<string, number>();
  /** Number of each path's parent path; NONE for the root. */
  readonly #parentPath: number[] = [];
  readonly #concurrent = new Set<number>();
  #read = 0;

  constructor(journal: Journal) {
    this.journal = journal;
  }

  /** Number of calls. */
  get length(): number {
    return this.#begin.length;
  }

  /** Number of events that were read. */
  get read(): number {
    return this.#read;
  }

  /** Number of known paths. */
  get paths(): number {
    return this.#parentPath.length;
  }

  /** States of which two children ran at once, by the numbers of their paths. */
  get concurrent(): ReadonlySet<number> {
    return this.#concurrent;
  }

  /** Reads the new events of the journal. */
  follow(): void {
    const { journal } = this;
    for (; this.#read < journal.length; this.#read++) {
      const kind = journal.kind(this.#read);
      if (kind === ENTERED) this.#entered(this.#read);
      // The journal only has earlier calls that are still open.
      else if (this.#read < journal.first) continue;
      else if (kind === LEFT) this.#left(this.#read);
      else this.#other(this.#read);
    }
  }

  /** Index of the call's entry in the journal. */
  begin(call: number): number {
    return this.#begin.at(call);
  }

  /** Index of the call's end in the journal; NONE while it is open. */
  end(call: number): number {
    return this.#end.at(call);
  }

  /** `OPEN`, `ENDED`, `TAKEN_BACK` or `DROPPED`. */
  how(call: number): number {
    return this.#how.at(call);
  }

  pathNumber(call: number): number {
    return this.#path.at(call);
  }

  path(call: number): string {
    return this.journal.pathOf(this.#path.at(call));
  }

  /** The call around it; NONE for a root. */
  parent(call: number): number {
    return call < 0 ? NONE : this.#parent.at(call);
  }

  /** Number of calls around it. */
  depth(call: number): number {
    return this.#depth.at(call);
  }

  outcome(call: number): Outcome | null {
    return this.how(call) === ENDED ? this.journal.outcome(this.end(call)) : null;
  }

  /** True if it was entered backwards. */
  isBack(call: number): boolean {
    return this.journal.isBack(this.begin(call));
  }

  began_ns(call: number): number {
    return this.journal.t_ns(this.begin(call));
  }

  /** Time of its end; while it is open, `now_ns`. */
  ended_ns(call: number, now_ns: number): number {
    const end = this.end(call);
    return end === NONE ? Math.max(now_ns, this.began_ns(call)) : this.journal.t_ns(end);
  }

  /** Calls inside a call, in order; for NONE the outermost calls. */
  inside(call: number): readonly number[] {
    return (call === NONE ? this.#roots : this.#inside.get(call)) ?? NO_CALLS;
  }

  /** All calls of a state, the oldest first. */
  of(path: string): readonly number[] {
    const number = this.#numbers.get(path);
    return (number === undefined ? undefined : this.#ofPath.get(number)) ?? NO_CALLS;
  }

  /** Number of the parent path; NONE for the root. */
  parentPath(path: number): number {
    return this.#parentPath[path] ?? NONE;
  }

  /** Last call that began at this event of the journal or before it; NONE if none did. */
  lastAt(index: number): number {
    return this.#begin.firstFrom(index + 1) - 1;
  }

  /** Innermost call that was open after this event, on the branch of the latest entry; NONE if none was. */
  openAt(index: number): number {
    let call = this.lastAt(index);
    while (call !== NONE && !this.isOpenAt(call, index)) call = this.parent(call);
    return call;
  }

  isOpenAt(call: number, index: number): boolean {
    const end = this.end(call);
    return this.begin(call) <= index && (end === NONE || end > index);
  }

  #entered(index: number): void {
    const path = this.#known(this.journal.pathNumber(index));
    this.#close(path, index, DROPPED);
    const around = this.parentPath(path);
    const parent = this.#open.get(around) ?? NONE;
    const call = this.#begin.length;
    this.#begin.push(index);
    this.#end.push(NONE);
    this.#how.push(OPEN);
    this.#path.push(path);
    this.#parent.push(parent);
    this.#depth.push(parent === NONE ? 0 : this.#depth.at(parent) + 1);
    listOf(this.#ofPath, path).push(call);
    this.#open.set(path, call);
    if (parent === NONE) {
      this.#roots.push(call);
      return;
    }
    const inside = listOf(this.#inside, parent);
    if (this.#hasOpen(inside)) this.#concurrent.add(around);
    inside.push(call);
  }

  /** True if one of these calls is open. Among siblings, only the last one is checked. */
  #hasOpen(calls: readonly number[]): boolean {
    const last = calls.at(-1);
    return last !== undefined && this.how(last) === OPEN;
  }

  #left(index: number): void {
    const how = this.journal.isBack(index) ? TAKEN_BACK : ENDED;
    this.#close(this.#known(this.journal.pathNumber(index)), index, how);
  }

  #other(index: number): void {
    const event = this.journal.other(index);
    if (event?.type === "resumed") this.#closeAll(index);
    else if (event?.type === "dropped") {
      const path = this.#numbers.get(event.path);
      if (path !== undefined) this.#close(path, index, DROPPED);
    }
  }

  /** Ends the open call of a state, and all open calls inside it. */
  #close(path: number, index: number, how: number): void {
    const call = this.#open.get(path);
    if (call === undefined) return;
    for (const [inner, other] of this.#open) {
      if (other > call && this.#isInside(other, call)) this.#finish(inner, other, index, DROPPED);
    }
    this.#finish(path, call, index, how);
  }

  #closeAll(index: number): void {
    for (const [path, call] of [...this.#open]) this.#finish(path, call, index, DROPPED);
  }

  #finish(path: number, call: number, index: number, how: number): void {
    this.#end.set(call, index);
    this.#how.set(call, how);
    this.#open.delete(path);
  }

  #isInside(call: number, outer: number): boolean {
    let at = this.parent(call);
    while (at > outer) at = this.parent(at);
    return at === outer;
  }

  /** Returns the number of a path after registering all paths up to it. */
  #known(number: number): number {
    for (let next = this.#parentPath.length; next <= number; next++) {
      const path = this.journal.pathOf(next);
      this.#numbers.set(path, next);
      const around = parentOf(path);
      this.#parentPath.push(around === null ? NONE : (this.#numbers.get(around) ?? NONE));
    }
    return number;
  }
}

function listOf(lists: Map<number, number[]>, key: number): number[] {
  let list = lists.get(key);
  if (!list) {
    list = [];
    lists.set(key, list);
  }
  return list;
}

const knownCalls = perOwner((journal: Journal) => new Calls(journal));

/** Calls of a journal up to its current end. */
export function callsOf(journal: Journal): Calls {
  const calls = knownCalls(journal);
  calls.follow();
  return calls;
}
