/** The content of libraries: each is asked for once, and again when files have changed. */

import type { Document } from "../model/generated/protocol.ts";
import { isSame } from "../model/json.ts";
import type { Machine } from "../model/machine.ts";
import { machineOf } from "../model/plain_machine.ts";
import type { LibraryKey } from "../store/document/graft.ts";
import type { Server } from "../store/page/server.ts";

interface CachedLibrary {
  readonly document: Document;
  readonly machine: Machine;
}

/** Told when the content of a library is here, or is another one. */
type Arrived = (key: LibraryKey) => void;

export class LibraryCache {
  readonly #request: Server["request"];
  readonly #route: (key: LibraryKey) => string;
  readonly #held = new Map<LibraryKey, CachedLibrary>();
  readonly #loading = new Map<LibraryKey, Promise<void>>();
  readonly #listeners = new Set<Arrived>();
  readonly #lookers = new Set<() => void>();

  /** `route` is the path of the content of a library. */
  constructor(request: Server["request"], route: (key: LibraryKey) => string = libraryRoute) {
    this.#request = request;
    this.#route = route;
  }

  get(key: LibraryKey): Machine | undefined {
    return this.#held.get(key)?.machine;
  }

  onArrival(listener: Arrived): () => void {
    this.#listeners.add(listener);
    return () => void this.#listeners.delete(listener);
  }

  /** Told when files have changed, also those of libraries whose content nobody has asked for. */
  onLook(looker: () => void): () => void {
    this.#lookers.add(looker);
    return () => void this.#lookers.delete(looker);
  }

  /** Gets the content unless it is here or on its way. Fails if the server refuses it. */
  load(key: LibraryKey): Promise<void> {
    if (this.#held.has(key)) return Promise.resolve();
    let loading = this.#loading.get(key);
    if (!loading) {
      loading = this.#fetch(key).finally(() => this.#loading.delete(key));
      this.#loading.set(key, loading);
    }
    return loading;
  }

  /** Checks the libraries after a change of files. A deleted library keeps its last content. */
  async refresh(): Promise<void> {
    for (const key of [...this.#held.keys()]) await this.#fetch(key).catch(() => {});
    for (const looker of this.#lookers) looker();
  }

  async #fetch(key: LibraryKey): Promise<void> {
    const document = await this.#request<Document>("GET", this.#route(key));
    const before = this.#held.get(key);
    if (before && isSame(before.document, document)) return;
    this.#held.set(key, { document, machine: machineOf(document) });
    for (const listener of this.#listeners) listener(key);
  }
}

function libraryRoute(key: LibraryKey): string {
  return `/libraries/${key.split("/").map(encodeURIComponent).join("/")}`;
}
