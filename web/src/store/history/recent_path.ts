/** The way that a run came lately: on each branch the states that ended and the transitions that were taken, a dozen steps back.
 * Goes on from where it was as the journal grows. */

import { parentOf } from "../../model/path.ts";
import { ENTERED, type Journal, LEFT } from "./journal.ts";

/** So many steps back the way of a branch is remembered. */
export const STEPS = 12;
/** So many events before the one that it begins at are looked at. */
const LOOK_BACK = 4_000;
/** Ends of one container's children that are kept, to step back over. After more steps back it is unknown where the container
 * continues from, until another child ends. */
const ENDS_MAX = 64;
/** So many steps of each branch are kept when its concurrency state ends. */
const LEFT_OVER = 3;

/** A transition that was taken: of its container, from the outcome of a child; from nothing: the start. */
export interface TakenTransition {
  readonly container: string;
  readonly from: string | null;
  readonly outcome: number;
}

/** The path of a child, or an outcome of its container. */
export type TransitionGoal = string | number;

/** What lies behind on a branch. */
interface RecentStep {
  /** The state that ended, or null if it is a transition alone. */
  readonly path: string | null;
  readonly taken: TakenTransition | null;
  /** Where the transition must have led: to this child, or to this outcome of its container. */
  readonly goal: TransitionGoal;
  /** The outcome by which the state ended; 0 of a transition alone. */
  readonly outcome: number;
  readonly sequence: number;
  /** How many states of the branch have ended since. */
  readonly age: number;
}

interface Item {
  readonly path: string | null;
  readonly taken: TakenTransition | null;
  readonly goal: TransitionGoal;
  readonly outcome: number;
  readonly sequence: number;
  /** How many states of the branch had ended by then. */
  readonly at: number;
}

interface BranchPath {
  ends: number;
  items: Item[];
}

interface StateEnd {
  readonly path: string;
  readonly outcome: number;
}

/** Ends of a container's children since it was entered, the newest last. */
interface ChildEnds {
  readonly ends: StateEnd[];
  /** False if earlier ends may be missing. */
  isComplete: boolean;
}

export class RecentPath {
  readonly #isConcurrent: (path: string) => boolean;
  readonly #paths = new Map<string, BranchPath>();
  /** By container. Without an entry the ends are unknown. */
  readonly #ends = new Map<string, ChildEnds>();
  readonly #branches = new Map<string, string>();
  #at = 0;

  constructor(isConcurrent: (path: string) => boolean) {
    this.#isConcurrent = isConcurrent;
  }

  /** Goes on up to an event by its index, that one left out. */
  follow(journal: Journal, until: number): void {
    this.#at = Math.max(this.#at, journal.first, until - LOOK_BACK);
    for (; this.#at < until; this.#at++) {
      const kind = journal.kind(this.#at);
      if (kind === ENTERED) this.#entered(journal, this.#at);
      else if (kind === LEFT) this.#left(journal, this.#at);
    }
  }

  /** What lies behind, of all branches, the oldest first. */
  past(): readonly RecentStep[] {
    return [...this.#paths.values()].flatMap(({ ends, items }) =>
      items.map(({ at, ...item }) => ({ ...item, age: ends - at })),
    );
  }

  /** Where the container continues from: its child that ended last, or its start; null if that is unknown. */
  from(container: string): TakenTransition | null {
    const { ends, isComplete } = this.#endsIn(container);
    const end = ends.at(-1);
    if (!end) return isComplete ? { container, from: null, outcome: 0 } : null;
    return { container, from: end.path, outcome: end.outcome };
  }

  #endsIn(container: string): ChildEnds {
    return this.#ends.get(container) ?? { ends: [], isComplete: false };
  }

  /** The branch that a state belongs to: a child of a concurrency state; empty on the root's. */
  branch(path: string): string {
    const known = this.#branches.get(path);
    if (known !== undefined) return known;
    const parent = parentOf(path);
    const found = parent === null ? "" : this.#isConcurrent(parent) ? path : this.branch(parent);
    this.#branches.set(path, found);
    return found;
  }

  #entered(journal: Journal, index: number): void {
    const path = journal.pathOf(journal.pathNumber(index));
    const parent = parentOf(path);
    if (journal.isBack(index)) {
      this.#undo(path, parent);
      return;
    }
    this.#ends.set(path, { ends: [], isComplete: true });
    if (parent === null || this.#isConcurrent(parent)) return;
    const branchPath = this.#pathOf(this.branch(path));
    const taken = this.from(parent);
    const sequence = journal.sequence(index);
    put(branchPath, { path: null, taken, goal: path, outcome: 0, sequence, at: branchPath.ends });
  }

  #left(journal: Journal, index: number): void {
    const path = journal.pathOf(journal.pathNumber(index));
    const parent = parentOf(path);
    if (journal.isBack(index)) {
      // What an earlier visit of the state did is not kept.
      this.#ends.delete(path);
      if (parent !== null) this.#untake(path);
      return;
    }
    const sequence = journal.sequence(index);
    const branchPath = this.#pathOf(this.branch(path));
    const isConcurrent = this.#isConcurrent(path);
    if (isConcurrent) this.#join(path, branchPath);
    branchPath.ends += 1;
    const taken = isConcurrent || this.#endsIn(path).ends.length === 0 ? null : this.from(path);
    const outcome = journal.outcome(index)?.id ?? 0;
    put(branchPath, { path, taken, goal: outcome, outcome, sequence, at: branchPath.ends });
    if (parent !== null) this.#ended(parent, path, outcome);
  }

  #ended(parent: string, path: string, outcome: number): void {
    const known = this.#endsIn(parent);
    known.ends.push({ path, outcome });
    if (known.ends.length > ENDS_MAX) {
      known.ends.shift();
      known.isComplete = false;
    }
    this.#ends.set(parent, known);
  }

  /** The branches of a concurrency state end in the one around it. */
  #join(path: string, branchPath: BranchPath): void {
    for (const [branch, { ends, items }] of this.#paths) {
      if (parentOf(branch) !== path) continue;
      this.#paths.delete(branch);
      const kept = items.filter(({ at }) => ends - at < LEFT_OVER);
      for (const item of kept) put(branchPath, { ...item, at: branchPath.ends - (ends - item.at) });
    }
  }

  /** The state is entered backwards: its end and all after it have not been. */
  #undo(path: string, parent: string | null): void {
    const branchPath = this.#pathOf(this.branch(path));
    const at = branchPath.items.findLastIndex((item) => item.path === path);
    if (at >= 0) {
      branchPath.ends = (branchPath.items[at]?.at ?? 1) - 1;
      branchPath.items.length = at;
    }
    if (parent !== null) this.#unend(parent, path);
  }

  #unend(parent: string, path: string): void {
    const { ends } = this.#endsIn(parent);
    const at = ends.findLastIndex((end) => end.path === path);
    // Only children of a concurrency state end in another order than they are undone.
    const isLast = at === ends.length - 1 || this.#isConcurrent(parent);
    if (at < 0 || !isLast) this.#ends.delete(parent);
    else ends.splice(at, 1);
  }

  /** The state is left backwards: the transition that led to it has not been taken. */
  #untake(path: string): void {
    const { items } = this.#pathOf(this.branch(path));
    const at = items.findLastIndex((item) => item.path === null && item.goal === path);
    if (at >= 0) items.splice(at, 1);
  }

  #pathOf(branch: string): BranchPath {
    const known = this.#paths.get(branch);
    if (known) return known;
    const path = { ends: 0, items: [] };
    this.#paths.set(branch, path);
    return path;
  }
}

function put(path: BranchPath, item: Item): void {
  path.items.push(item);
  const oldest = path.items.findIndex(({ at }) => at > path.ends - STEPS);
  if (oldest > 0) path.items.splice(0, oldest);
}
