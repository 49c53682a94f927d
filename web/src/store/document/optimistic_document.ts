/** An open machine as the server sent it, updated by its changes. The predicted effects of pending edits are applied on top and can
 * be rolled back at any time. Knows documents and changes; never their source. */

import type {
  Change,
  Document,
  HeaderDocument,
  StateDocument,
} from "../../model/generated/protocol.ts";
import { isSame } from "../../model/json.ts";
import type { Machine } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";
import { type ContentOf, Graft } from "./graft.ts";
import { placed, withList } from "./lists.ts";
import type { Write } from "./predict/predicted_machine.ts";
import { type Earlier, States } from "./states.ts";

/** Paths of changed states; null if all may have changed. */
export type TouchedPaths = ReadonlySet<string> | null;

/** Capacity of the version history. */
const REMEMBERED = 16;

export class OptimisticDocument implements Machine {
  readonly #states = new States();
  readonly #graft: Graft;
  #version = 1;
  /** The last versions with the paths that they changed. */
  #history: { readonly version: number; readonly touched: TouchedPaths }[] = [];
  #root = "";
  #header: HeaderDocument;
  /** Original states and header of predicted changes; null without predictions. */
  #optimistic: { states: ReturnType<States["watch"]>; header: HeaderDocument } | null = null;

  constructor(document: Document, contentOf: ContentOf) {
    this.#graft = new Graft((path) => this.#states.get(path), contentOf);
    this.#header = document.header;
    this.#fill(document);
  }

  get version(): number {
    return this.#version;
  }

  get root(): string {
    return this.#root;
  }

  get header(): HeaderDocument {
    return this.#header;
  }

  state(path: string): StateDocument | undefined {
    return this.#states.get(path) ?? this.#graft.state(path);
  }

  children(path: string): readonly string[] {
    return this.#states.children(path) ?? this.#graft.children(path);
  }

  isInLibrary(path: string): boolean {
    return !this.#states.get(path) && this.#graft.state(path) !== undefined;
  }

  paths(): Iterable<string> {
    return this.#states.paths(this.#root);
  }

  /** Runs `work` and returns the paths of changed states. A state with equal content keeps its object. */
  transact(work: () => void): TouchedPaths {
    const { earlier, stop } = this.#states.watch();
    const header = this.#header;
    work();
    stop();
    const touched = new Set<string>();
    for (const [path, before] of earlier) {
      const now = this.#states.get(path);
      if (now === before) continue;
      if (now && before && isSame(now, before)) this.#states.put(before);
      else touch(touched, path, before, now);
    }
    if (header !== this.#header) touched.add(this.#root);
    if (touched.size === 0) return touched;
    this.#nextVersion(touched);
    const libraryAt = (path: string) =>
      earlier.get(path)?.library ?? this.#states.get(path)?.library;
    if ([...touched].some(libraryAt)) this.#graft.forget();
    return touched;
  }

  /** Replaces the machine and drops all predictions. */
  reset(document: Document): void {
    this.#optimistic?.states.stop();
    this.#optimistic = null;
    this.#header = document.header;
    this.#fill(document);
    this.libraryChanged();
  }

  /** Call it when the content of a library has changed. */
  libraryChanged(): void {
    this.#graft.forget();
    this.#nextVersion(null);
  }

  touchedSince(version: number): TouchedPaths {
    const since = this.#history.filter((entry) => entry.version > version);
    if (since.length !== this.#version - version) return null;
    const all = new Set<string>();
    for (const { touched } of since) {
      if (touched === null) return null;
      for (const path of touched) all.add(path);
    }
    return all;
  }

  #nextVersion(touched: TouchedPaths): void {
    this.#version += 1;
    this.#history.push({ version: this.#version, touched });
    if (this.#history.length > REMEMBERED) this.#history.shift();
  }

  /** Rolls back all predictions. */
  rollback(): void {
    if (!this.#optimistic) return;
    const { states, header } = this.#optimistic;
    this.#optimistic = null;
    states.stop();
    this.#states.restore(states.earlier);
    this.#header = header;
  }

  /** Applies the changes of one revision and returns the replaced states. Roll back predictions first. */
  confirm(changes: readonly Change[]): Earlier {
    const { earlier, stop } = this.#states.watch();
    for (const change of changes) this.#change(change);
    stop();
    return earlier;
  }

  /** Applies the predicted writes of an edit. */
  applyOptimistic(writes: readonly Write[]): void {
    this.#optimistic ??= { states: this.#states.watch(), header: this.#header };
    for (const write of writes) {
      if ("put" in write) this.#states.put(write.put);
      else if ("remove" in write) this.#states.remove(write.remove);
      else this.#header = write.header;
    }
  }

  #fill(document: Document): void {
    this.#states.fill(document.states);
    this.#root = document.states[0]?.path ?? "";
  }

  #change(change: Change): void {
    switch (change.change) {
      case "header":
        this.#header = change.header;
        break;
      case "state_removed":
        this.#states.remove(change.path);
        break;
      case "state":
        this.#states.put(withConnections(change.state, this.#states.get(change.state.path)));
        if (parentOf(change.state.path) === null) this.#root = change.state.path;
        break;
      case "transition":
        this.#update(change.path, (state) =>
          withList(state, "transitions", placed(state.transitions, change.id, change.transition)),
        );
        break;
      case "data_flow":
        this.#update(change.path, (state) =>
          withList(state, "data_flows", placed(state.data_flows, change.id, change.data_flow)),
        );
    }
  }

  #update(path: string, next: (state: StateDocument) => StateDocument): void {
    const state = this.#states.get(path);
    if (state) this.#states.put(next(state));
  }
}

/** A state that is sent without connections keeps its current ones. */
function withConnections(state: StateDocument, earlier: StateDocument | undefined): StateDocument {
  const { transitions, data_flows } = earlier ?? {};
  return {
    ...state,
    ...(transitions ? { transitions } : {}),
    ...(data_flows ? { data_flows } : {}),
  };
}

function touch(
  touched: Set<string>,
  path: string,
  before: StateDocument | undefined,
  now: StateDocument | undefined,
): void {
  touched.add(path);
  const parent = parentOf(path);
  if (parent !== null && !before !== !now) touched.add(parent);
}
