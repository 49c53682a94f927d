/** States by path with their children in order, and what stood at each path before it was written: so that what was written can
 * be taken back, and what came of it told. */

import type { StateDocument } from "../../model/generated/protocol.ts";
import { parentOf } from "../../model/path.ts";

const NONE: readonly string[] = [];

/** What stood at a path when it was written for the first time; undefined: nothing. */
export type Earlier = Map<string, StateDocument | undefined>;

export class States {
  readonly #states = new Map<string, StateDocument>();
  readonly #children = new Map<string, readonly string[]>();
  readonly #watching = new Set<Earlier>();

  /** Takes these states, a state before its children and those by rising id, instead of all others. */
  fill(documents: readonly StateDocument[]): void {
    this.#states.clear();
    this.#children.clear();
    const children = new Map<string, string[]>();
    for (const document of documents) {
      this.#states.set(document.path, document);
      const parent = parentOf(document.path);
      if (parent === null) continue;
      const siblings = children.get(parent);
      if (siblings) siblings.push(document.path);
      else children.set(parent, [document.path]);
    }
    for (const [parent, paths] of children) this.#children.set(parent, paths);
  }

  get(path: string): StateDocument | undefined {
    return this.#states.get(path);
  }

  /** Undefined if there are none. */
  children(path: string): readonly string[] | undefined {
    return this.#children.get(path);
  }

  /** A state before its children, those by rising id. */
  *paths(root: string): Iterable<string> {
    const open = this.#states.has(root) ? [root] : [];
    for (let path = open.pop(); path !== undefined; path = open.pop()) {
      yield path;
      const children = this.#children.get(path) ?? NONE;
      for (let at = children.length - 1; at >= 0; at -= 1) open.push(children[at] ?? root);
    }
  }

  put(document: StateDocument): void {
    this.#write(document.path, document);
  }

  /** Takes the state away with everything inside it. */
  remove(path: string): void {
    for (const inner of [...this.paths(path)].reverse()) this.#write(inner, undefined);
  }

  /** From now on remembers what stood where something is written, until it is told to stop. */
  watch(): { readonly earlier: Earlier; readonly stop: () => void } {
    const earlier: Earlier = new Map();
    this.#watching.add(earlier);
    return { earlier, stop: () => void this.#watching.delete(earlier) };
  }

  /** Writes back what stood there. */
  restore(earlier: Earlier): void {
    for (const [path, document] of earlier) this.#write(path, document);
  }

  #write(path: string, document: StateDocument | undefined): void {
    const before = this.#states.get(path);
    if (before === document) return;
    for (const earlier of this.#watching) if (!earlier.has(path)) earlier.set(path, before);
    if (document) this.#states.set(path, document);
    else this.#states.delete(path);
    if (!before !== !document) this.#line(path, document !== undefined);
  }

  /** Puts the path in line with its siblings, or takes it out. */
  #line(path: string, isThere: boolean): void {
    const parent = parentOf(path);
    if (parent === null) return;
    const others = (this.#children.get(parent) ?? NONE).filter((sibling) => sibling !== path);
    const at = others.findIndex((sibling) => sibling > path);
    const siblings = isThere ? others.toSpliced(at < 0 ? others.length : at, 0, path) : others;
    if (siblings.length === 0) this.#children.delete(parent);
    else this.#children.set(parent, siblings);
  }
}
