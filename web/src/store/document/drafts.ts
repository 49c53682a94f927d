/** Texts that somebody is still writing: scripts and descriptions that are not applied to the machine yet. They live in the
 * browser's storage, each under a key of its own, until they are applied or given up. */

import { type ReadonlySignal, signal } from "@preact/signals-core";

/** Whose text it is. */
export interface DraftPlace {
  /** The server's id of the machine, which is the same whenever its folder is opened. */
  readonly machine: string;
  readonly path: string;
  readonly field: "script" | "description";
}

export interface FieldDraft extends DraftPlace {
  readonly text: string;
  /** What the machine said when the draft was begun: if it says something else now, somebody else has changed it. */
  readonly base: string;
}

/** As much of the browser's storage as is needed. */
export type DraftStorage = Pick<Storage, "getItem" | "setItem" | "removeItem" | "key" | "length">;

export interface Drafts {
  readonly all: ReadonlySignal<ReadonlyMap<string, FieldDraft>>;
  readonly get: (place: DraftPlace) => FieldDraft | undefined;
  readonly keep: (draft: FieldDraft) => void;
  readonly drop: (place: DraftPlace) => void;
  /** Lets the drafts of a state and of those inside it follow to another path. */
  readonly move: (machine: string, from: string, to: string) => void;
}

const PREFIX = "rafcon.draft:";

export function draftKey({ machine, path, field }: DraftPlace): string {
  return `${machine}:${field}:${path}`;
}

/** Drafts that are kept in this storage; without one they last as long as the page. */
export function openDrafts(storage: DraftStorage | null): Drafts {
  const all = signal<ReadonlyMap<string, FieldDraft>>(storage ? stored(storage) : new Map());
  const drop = (place: DraftPlace) => {
    const key = draftKey(place);
    if (!all.peek().has(key)) return;
    const left = new Map(all.peek());
    left.delete(key);
    all.value = left;
    storage?.removeItem(PREFIX + key);
  };
  const keep = (draft: FieldDraft) => {
    const key = draftKey(draft);
    all.value = new Map(all.peek()).set(key, draft);
    try {
      storage?.setItem(PREFIX + key, JSON.stringify(draft));
    } catch {
      // The storage is full: the draft lives as long as the page.
    }
  };
  const move = (machine: string, from: string, to: string) => {
    for (const draft of all.peek().values()) {
      const isInside = draft.path === from || draft.path.startsWith(`${from}/`);
      if (draft.machine !== machine || !isInside) continue;
      drop(draft);
      keep({ ...draft, path: to + draft.path.slice(from.length) });
    }
  };
  return { all, get: (place) => all.value.get(draftKey(place)), keep, drop, move };
}

function stored(storage: DraftStorage): ReadonlyMap<string, FieldDraft> {
  const found = new Map<string, FieldDraft>();
  for (let index = 0; index < storage.length; index++) {
    const key = storage.key(index);
    const text = key?.startsWith(PREFIX) ? storage.getItem(key) : null;
    const draft = text === null ? null : read(text);
    if (draft) found.set(draftKey(draft), draft);
  }
  return found;
}

function read(text: string): FieldDraft | null {
  try {
    const { machine, path, field, text: draft, base } = JSON.parse(text) as Record<string, unknown>;
    const texts = [machine, path, draft, base];
    if (texts.some((part) => typeof part !== "string")) return null;
    if (field !== "script" && field !== "description") return null;
    return { machine, path, field, text: draft, base } as FieldDraft;
  } catch {
    return null;
  }
}

function browserStorage(): DraftStorage | null {
  try {
    return globalThis.localStorage ?? null;
  } catch {
    return null;
  }
}

/** The drafts of this browser. */
export const drafts: Drafts = openDrafts(browserStorage());
