/** Predicted effect of an edit: pending writes on a machine. */

import type { HeaderDocument, StateDocument } from "../../../model/generated/protocol.ts";
import type { Machine } from "../../../model/machine.ts";
import { isWithin, lineage } from "../../../model/path.ts";

export type Write =
  | { readonly put: StateDocument }
  | { readonly remove: string }
  | { readonly header: HeaderDocument };

/** The machine with the pending writes applied. */
export class PredictedMachine {
  readonly writes: Write[] = [];
  readonly #machine: Machine;
  readonly #states = new Map<string, StateDocument | null>();
  #hasRemoved = false;
  #header: HeaderDocument;

  constructor(machine: Machine) {
    this.#machine = machine;
    this.#header = machine.header;
  }

  get root(): string {
    return this.#machine.root;
  }

  get header(): HeaderDocument {
    return this.#header;
  }

  /** The state; undefined inside libraries. */
  state(path: string): StateDocument | undefined {
    const own = this.#states.get(path);
    if (own) return own;
    if (this.#isGone(path)) return undefined;
    return this.#machine.isInLibrary(path) ? undefined : this.#machine.state(path);
  }

  #isGone(path: string): boolean {
    return this.#hasRemoved && lineage(path).some((outer) => this.#states.get(outer) === null);
  }

  /** The state and all states inside it, except inside libraries. */
  inside(path: string): readonly StateDocument[] {
    const paths = new Set<string>();
    const open = [path];
    for (let next = open.pop(); next !== undefined; next = open.pop()) {
      if (this.#machine.isInLibrary(next)) continue;
      paths.add(next);
      open.push(...this.#machine.children(next));
    }
    for (const written of this.#states.keys()) if (isWithin(written, path)) paths.add(written);
    return [...paths].flatMap((each) => this.state(each) ?? []);
  }

  put(state: StateDocument): void {
    this.#states.set(state.path, state);
    this.writes.push({ put: state });
  }

  remove(path: string): void {
    for (const inner of this.#states.keys()) {
      if (inner.startsWith(`${path}/`)) this.#states.delete(inner);
    }
    this.#states.set(path, null);
    this.#hasRemoved = true;
    this.writes.push({ remove: path });
  }

  setHeader(header: HeaderDocument): void {
    this.#header = header;
    this.writes.push({ header });
  }
}
