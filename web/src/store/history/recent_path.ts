/** Recent path of a run: the ended states and taken transitions of each branch, a dozen steps back. It is updated as the journal
 * grows. */

import { parentOf } from "../../model/path.ts";
import { ENTERED, type Journal, LEFT } from "./journal.ts";

/** Number of steps that are remembered per branch. */
export const STEPS = 12;
/** Greatest number of events to read before the requested one. */
const LOOK_BACK = 4_000;
/** Capacity of ends of a container's children, for steps back. After more steps back, the position of the container is unknown
 * until another child ends. */
const ENDS_MAX = 64;
/** Number of steps per branch that are kept when its concurrency state ends. */
const LEFT_OVER = 3;

/** A taken transition of a container, from the outcome of a child; `from` is null for the start. */
export interface TakenTransition {
  readonly container: string;
  readonly from: string | null;
  readonly outcome: number;
}

/** Path of a child, or an outcome of its container. */
export type TransitionGoal = string | number;

/** A past step of a branch. */
interface RecentStep {
  /** State that ended; null for a transition alone. */
  readonly path: string | null;
  readonly taken: TakenTransition | null;
  /** Target of the transition: this child, or this outcome of its container. */
  readonly goal: TransitionGoal;
  /** Outcome of the ended state; 0 for a transition alone. */
  readonly outcome: number;
  readonly sequence: number;
  /** Number of states of the branch that have ended since. */
  readonly age: number;
}

interface Item {
  readonly path: string | null;
  readonly taken: TakenTransition | null;
  readonly goal: TransitionGoal;
  readonly outcome: number;
  readonly sequence: number;
  /** Number of states of the branch that had ended by then. */
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

  /** Reads events up to an index, exclusive. */
  follow(journal: Journal, until: number): void {
    this.#at = Math.max(this.#at, journal.first, until - LOOK_BACK);
    for (; this.#at < until; this.#at++) {
      const kind = journal.kind(this.#at);
      if (kind === ENTERED) this.#entered(journal, this.#at);
      else if (kind === LEFT) this.#left(journal, this.#at);
    }
  }

  /** Past steps of all branches, the oldest first. */
  past(): readonly RecentStep[] {
    return [...this.#paths.values()].flatMap(({ ends, items }) =>
      items.map(({ at, ...item }) => ({ ...item, age: ends - at })),
    );
  }

  /** Position from which the container continues: its child that ended last, or its start; null if unknown. */
  from(container: string): TakenTransition | null {
    const { ends, isComplete } = this.#endsIn(container);
    const end = ends.at(-1);
    if (!end) return isComplete ? { container, from: null, outcome: 0 } : null;
    return { container, from: end.path, outcome: end.outcome };
  }

  #endsIn(container: string): ChildEnds {
    return this.#ends.get(container) ?? { ends: [], isComplete: false };
  }

  /** Branch of a state: a child of a concurrency state; empty for the root's branch. */
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
      // Ends of an earlier visit are not kept.
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

  /** Moves the last steps of a concurrency state's branches to the branch around it. */
  #join(path: string, branchPath: BranchPath): void {
    for (const [branch, { ends, items }] of this.#paths) {
      if (parentOf(branch) !== path) continue;
      this.#paths.delete(branch);
      const kept = items.filter(({ at }) => ends - at < LEFT_OVER);
      for (const item of kept) put(branchPath, { ...item, at: branchPath.ends - (ends - item.at) });
    }
  }

  /** Handles a backward entry: removes the end of the state and all later steps. */
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

  /** Handles a backward end: removes the transition that led to the state. */
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
