/** Lanes of a run: one per branch of concurrency, the root's first. Each has rows by depth with consecutive calls. Calls are read
 * as they arrive. A state counts as concurrent once two of its children run at once. All calls are then assigned to lanes again, so
 * that equal events always give equal lanes. */

import { ABORTED, PREEMPTED } from "../../model/machine.ts";
import { perOwner } from "../../model/per_owner.ts";
import type { Calls } from "./calls.ts";
import { DROPPED, NONE, OPEN, TAKEN_BACK } from "./calls.ts";
import { lowerBound } from "./column.ts";

/** Appearance of a call. */
export type CallLook = "open" | "ended" | "aborted" | "preempted" | "back" | "dropped";

export function lookOf(calls: Calls, call: number): CallLook {
  if (calls.isBack(call)) return "back";
  switch (calls.how(call)) {
    case OPEN:
      return "open";
    case TAKEN_BACK:
      return "back";
    case DROPPED:
      return "dropped";
    default: {
      const outcome = calls.outcome(call)?.id;
      return outcome === ABORTED ? "aborted" : outcome === PREEMPTED ? "preempted" : "ended";
    }
  }
}

/** True if it ended with *aborted*, or left an error. False for calls that were taken back. */
export function hasFailed(calls: Calls, call: number): boolean {
  const look = lookOf(calls, call);
  if (look === "back" || look === "open" || look === "dropped") return false;
  return look === "aborted" || calls.journal.hasError(calls.end(call));
}

/** Consecutive calls at one depth of a branch. */
export class CallRow {
  readonly calls: number[] = [];
  /** Number of failed calls before each place. */
  readonly #failed: number[] = [0];
  readonly #all: Calls;

  constructor(all: Calls) {
    this.#all = all;
  }

  add(call: number): void {
    this.calls.push(call);
  }

  /** Place of the first call in the row that has not ended by this event of the journal. */
  firstOpenAfter(index: number): number {
    return lowerBound(this.calls.length, (place) => {
      const end = this.#all.end(this.calls[place] ?? NONE);
      return end !== NONE && end <= index;
    });
  }

  /** Place of the first call in the row that began at this event of the journal or later. */
  firstFrom(index: number): number {
    return lowerBound(
      this.calls.length,
      (place) => this.#all.begin(this.calls[place] ?? NONE) < index,
    );
  }

  /** Number of failed calls from one place of the row up to another, exclusive. */
  failed(from: number, to: number): number {
    this.#count();
    const last = this.#failed.length - 1;
    return (this.#failed[Math.min(to, last)] ?? 0) - (this.#failed[Math.min(from, last)] ?? 0);
  }

  #count(): void {
    for (let at = this.#failed.length - 1; at < this.calls.length; at++) {
      const call = this.calls[at] ?? NONE;
      if (this.#all.how(call) === OPEN) return;
      this.#failed.push((this.#failed[at] ?? 0) + (hasFailed(this.#all, call) ? 1 : 0));
    }
  }
}

export interface Lane {
  /** Path of the first state of the branch: the root, or the child of a concurrency state. */
  readonly path: string;
  /** Number of lanes around it. */
  readonly depth: number;
  /** Path of the branch around it; null for the root's. */
  readonly parent: string | null;
  readonly rows: readonly CallRow[];
  /** Calls without inner calls at the time of the next call: the states that did the work. */
  readonly leaves: CallRow;
}

interface LaneDraft extends Lane {
  readonly rows: CallRow[];
}

export class RunLanes {
  readonly #calls: Calls;
  #lanes = new Map<number, LaneDraft>();
  /** By path number: the path number of its lane, and its row. */
  #place: { readonly lane: number; readonly row: number }[] = [];
  #put = 0;
  #split = 0;
  #ordered: readonly Lane[] = [];

  constructor(calls: Calls) {
    this.#calls = calls;
  }

  /** All lanes in the order of their start, each after the lane around it. */
  all(): readonly Lane[] {
    return this.#ordered;
  }

  /** Lane and row of a state. */
  placeOf(path: number): { readonly lane: Lane; readonly row: number } | undefined {
    const place = this.#place[path];
    const lane = place && this.#lanes.get(place.lane);
    return lane && place && { lane, row: place.row };
  }

  /** Reads the new calls. */
  follow(): void {
    const calls = this.#calls;
    if (calls.concurrent.size !== this.#split) this.#again();
    const before = this.#lanes.size;
    for (; this.#put < calls.length; this.#put++) this.#add(this.#put);
    if (this.#lanes.size !== before) this.#ordered = inOrder([...this.#lanes.values()]);
  }

  #again(): void {
    this.#lanes = new Map();
    this.#place = [];
    this.#put = 0;
    this.#split = this.#calls.concurrent.size;
  }

  #add(call: number): void {
    const { lane, row } = this.#placed(this.#calls.pathNumber(call));
    const draft = this.#lane(lane);
    while (draft.rows.length <= row) draft.rows.push(new CallRow(this.#calls));
    draft.rows[row]?.add(call);
    const { calls } = draft.leaves;
    if (calls.at(-1) === this.#calls.parent(call)) calls.pop();
    calls.push(call);
  }

  #lane(path: number): LaneDraft {
    const known = this.#lanes.get(path);
    if (known) return known;
    const outer = this.#calls.parentPath(path);
    const parent = outer === NONE ? undefined : this.#lane(this.#placed(outer).lane);
    const lane: LaneDraft = {
      path: this.#calls.journal.pathOf(path),
      depth: parent ? parent.depth + 1 : 0,
      parent: parent?.path ?? null,
      rows: [],
      leaves: new CallRow(this.#calls),
    };
    this.#lanes.set(path, lane);
    return lane;
  }

  #placed(path: number): { readonly lane: number; readonly row: number } {
    const known = this.#place[path];
    if (known) return known;
    const parent = this.#calls.parentPath(path);
    const isFirst = parent === NONE || this.#calls.concurrent.has(parent);
    const outer = isFirst ? undefined : this.#placed(parent);
    const place = outer ? { lane: outer.lane, row: outer.row + 1 } : { lane: path, row: 0 };
    this.#place[path] = place;
    return place;
  }
}

interface Nested {
  readonly path: string;
  readonly parent: string | null;
}

/** Sorts lanes so that each follows the lane around it. */
export function inOrder<L extends Nested>(lanes: readonly L[]): readonly L[] {
  const inside = new Map<string | null, L[]>();
  for (const lane of lanes) {
    const list = inside.get(lane.parent);
    if (list) list.push(lane);
    else inside.set(lane.parent, [lane]);
  }
  const below = (path: string | null): readonly L[] =>
    (inside.get(path) ?? []).flatMap((lane) => [lane, ...below(lane.path)]);
  return below(null);
}

const knownRunLanes = perOwner((calls: Calls) => new RunLanes(calls));

/** Lanes of a run up to its last received event. */
export function lanesOf(calls: Calls): RunLanes {
  const lanes = knownRunLanes(calls);
  lanes.follow();
  return lanes;
}
