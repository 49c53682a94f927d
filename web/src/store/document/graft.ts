/** Content of libraries below the library states that run them, to any depth, as far as it is loaded. Resolves paths; loads nothing. */

import type { LibraryDocument, StateDocument } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import { childPath, idOf, parentOf } from "../../model/path.ts";

/** Key of a library: its path and name, joined by `/`. */
export type LibraryKey = string;

export function libraryKey(library: LibraryDocument): LibraryKey {
  return library.path === "" ? library.name : `${library.path}/${library.name}`;
}

/** Returns the content of a library, if it is loaded. */
export type ContentOf = (key: LibraryKey) => Machine | undefined;

interface GraftedState {
  readonly content: Machine;
  /** Path inside the library. */
  readonly inner: string;
}

const NONE: readonly string[] = [];

export class Graft {
  readonly #own: (path: string) => StateDocument | undefined;
  readonly #contentOf: ContentOf;
  readonly #found = new Map<string, GraftedState | null>();
  readonly #children = new Map<string, readonly string[]>();

  constructor(own: (path: string) => StateDocument | undefined, contentOf: ContentOf) {
    this.#own = own;
    this.#contentOf = contentOf;
  }

  /** Clears the cache. Call it when a library state, or the content of a library, has changed. */
  forget(): void {
    this.#found.clear();
    this.#children.clear();
  }

  /** A state inside a library. */
  state(path: string): StateDocument | undefined {
    const found = this.#find(path);
    return found?.content.state(found.inner);
  }

  /** Children of a state inside a library, or of a library state. */
  children(path: string): readonly string[] {
    let children = this.#children.get(path);
    if (!children) {
      children = this.#childrenOf(path);
      this.#children.set(path, children);
    }
    return children;
  }

  #childrenOf(path: string): readonly string[] {
    const library = (this.#own(path) ?? this.state(path))?.library;
    if (library) {
      const content = this.#contentOf(libraryKey(library));
      return content ? [childPath(path, content.root)] : NONE;
    }
    const found = this.#find(path);
    if (!found) return NONE;
    return found.content.children(found.inner).map((inner) => childPath(path, idOf(inner)));
  }

  #find(path: string): GraftedState | null {
    let found = this.#found.get(path);
    if (found === undefined) {
      found = this.#seek(path);
      this.#found.set(path, found);
    }
    return found;
  }

  #seek(path: string): GraftedState | null {
    const parent = parentOf(path);
    if (parent === null || this.#own(path)) return null;
    const own = this.#own(parent);
    const around = own ? null : this.#find(parent);
    const library = (own ?? around?.content.state(around.inner))?.library;
    if (library) {
      const content = this.#contentOf(libraryKey(library));
      return content?.root === idOf(path) ? { content, inner: content.root } : null;
    }
    if (!around) return null;
    const inner = childPath(around.inner, idOf(path));
    return around.content.state(inner) ? { content: around.content, inner } : null;
  }
}
