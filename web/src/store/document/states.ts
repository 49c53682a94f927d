/** States by path, with their children in order. Records the earlier state at each written path, to roll back writes and to report
 * what changed. */

import type { StateDocument } from "../../model/generated/protocol.ts";
import { parentOf } from "../../model/path.ts";

const NONE: readonly string[] = [];

/** State at each path before its first write; undefined if there was none. */
export type Earlier = Map<string, StateDocument | undefined>;

export class States {
  readonly #states = new Map<string, StateDocument>();
  readonly #children = new Map<string, readonly string[]>();
  readonly #watching = new Set<Earlier>();

  /** Replaces all states by these: parents before children, siblings by ascending id. */
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

  /** Undefined without children. */
  children(path: string): readonly string[] | undefined {
    return this.#children.get(path);
  }

  /** Parents before children, siblings by ascending id. */
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

  /** Removes the state with all states inside it. */
  remove(path: string): void {
    for (const inner of [...this.paths(path)].reverse()) this.#write(inner, undefined);
  }

  /** Records the earlier state at each written path until `stop` is called. */
  watch(): { readonly earlier: Earlier; readonly stop: () => void } {
    const earlier: Earlier = new Map();
    this.#watching.add(earlier);
    return { earlier, stop: () => void this.#watching.delete(earlier) };
  }

  /** Restores the earlier states. */
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

  /** Inserts the path among its siblings, or removes it. */
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
