/** Drafts of scripts and descriptions: texts that are not applied to the machine yet. Each is stored in the browser under its own
 * key until it is applied or discarded. */

import { type ReadonlySignal, signal } from "@preact/signals-core";
import { BROWSER_STORE, type LocalStore } from "../local_store.ts";

/** Owner of a draft. */
export interface DraftPlace {
  /** The server's id of the machine. It is constant for a folder. */
  readonly machine: string;
  readonly path: string;
  readonly field: "script" | "description";
}

export interface FieldDraft extends DraftPlace {
  readonly text: string;
  /** Text of the machine when the draft began. A different text now means that somebody else has changed it. */
  readonly base: string;
}

export interface Drafts {
  readonly all: ReadonlySignal<ReadonlyMap<string, FieldDraft>>;
  readonly get: (place: DraftPlace) => FieldDraft | undefined;
  readonly keep: (draft: FieldDraft) => void;
  readonly drop: (place: DraftPlace) => void;
  /** Moves the drafts of a state, and of the states inside it, to another path. */
  readonly move: (machine: string, from: string, to: string) => void;
}

const PREFIX = "rafcon.draft:";

export function draftKey({ machine, path, field }: DraftPlace): string {
  return `${machine}:${field}:${path}`;
}

/** Drafts in this store. A draft that cannot be stored lasts as long as the page. */
export function openDrafts(store: LocalStore): Drafts {
  const all = signal(stored(store));
  const drop = (place: DraftPlace) => {
    const key = draftKey(place);
    if (!all.peek().has(key)) return;
    const left = new Map(all.peek());
    left.delete(key);
    all.value = left;
    store.put(PREFIX + key, undefined);
  };
  const keep = (draft: FieldDraft) => {
    const key = draftKey(draft);
    all.value = new Map(all.peek()).set(key, draft);
    store.put(PREFIX + key, draft);
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

function stored(store: LocalStore): ReadonlyMap<string, FieldDraft> {
  const found = store.keys(PREFIX).map((key) => store.get(key));
  return new Map(found.filter(isDraft).map((draft) => [draftKey(draft), draft]));
}

function isDraft(value: unknown): value is FieldDraft {
  const { machine, path, field, text, base } = (value ?? {}) as Record<string, unknown>;
  const isText = [machine, path, text, base].every((part) => typeof part === "string");
  return isText && (field === "script" || field === "description");
}

/** Drafts of this browser. */
export const drafts: Drafts = openDrafts(BROWSER_STORE);
