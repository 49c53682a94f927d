/** Which state of one machine is which of another: by path, and where paths differ by id or content, so that what was moved or
 * got another id is not taken for something new. */

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

  /** These two are one, and so are children of the same id. */
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

  /** Looks for what has no counterpart at its place: by its id elsewhere, then by its content. */
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

/** What a state is, whatever its id is and wherever it stands. */
function contentOf(machine: Machine, path: string): string {
  const state = machine.state(path);
  if (!state) return path;
  const { path: _, id: __, layout: ___, transitions: _t, data_flows: _f, ...rest } = state;
  return JSON.stringify(rest);
}
