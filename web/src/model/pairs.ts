/** Pairs the states of two machines: by path, otherwise by id or content, so that a moved state, or one with a new id, does not
 * count as new. */

import type { Machine } from "./machine.ts";
import { childPath, idOf, parentOf } from "./path.ts";

/** Counterparts by path. A state without one is not in its map. */
export interface StatePairs {
  readonly oldOf: ReadonlyMap<string, string>;
  readonly newOf: ReadonlyMap<string, string>;
}

export function pairStates(old: Machine, now: Machine): StatePairs {
  const pairing = new Pairing(old, now);
  pairing.pairTree(old.root, now.root);
  pairing.pairStrays();
  return pairing;
}

class Pairing implements StatePairs {
  readonly oldOf = new Map<string, string>();
  readonly newOf = new Map<string, string>();
  readonly #old: Machine;
  readonly #now: Machine;

  constructor(old: Machine, now: Machine) {
    this.#old = old;
    this.#now = now;
  }

  /** Pairs two states, and their children with equal ids. */
  pairTree(old: string, now: string): void {
    const open: [string, string][] = [[old, now]];
    for (let pair = open.pop(); pair; pair = open.pop()) {
      const [before, after] = pair;
      this.oldOf.set(after, before);
      this.newOf.set(before, after);
      for (const child of this.#old.children(before)) {
        const same = childPath(after, idOf(child));
        if (this.#now.state(same) && this.#isFree(child, same)) open.push([child, same]);
      }
    }
  }

  /** Pairs the remaining states: by id at another path, then by content. */
  pairStrays(): void {
    for (const nameOf of [idAndKind, contentOf]) {
      const wanted = new Map<string, string[]>();
      for (const path of this.#strays(this.#now, this.oldOf)) {
        const name = nameOf(this.#now, path);
        wanted.set(name, [...(wanted.get(name) ?? []), path]);
      }
      for (const old of this.#strays(this.#old, this.newOf)) {
        const now = wanted.get(nameOf(this.#old, old))?.find((path) => this.#isFree(old, path));
        if (now !== undefined) this.pairTree(old, now);
      }
    }
  }

  #isFree(old: string, now: string): boolean {
    return !this.newOf.has(old) && !this.oldOf.has(now);
  }

  /** States without a counterpart, outer ones first. */
  #strays(machine: Machine, known: ReadonlyMap<string, string>): readonly string[] {
    return [...machine.paths()].filter((path) => !known.has(path) && parentOf(path) !== null);
  }
}

function idAndKind(machine: Machine, path: string): string {
  return `${machine.state(path)?.kind} ${idOf(path)}`;
}

/** Content of a state, independent of its id and path. */
function contentOf(machine: Machine, path: string): string {
  const state = machine.state(path);
  if (!state) return path;
  const { path: _, id: __, layout: ___, transitions: _t, data_flows: _f, ...rest } = state;
  return JSON.stringify(rest);
}
