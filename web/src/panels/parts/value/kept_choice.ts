/** Stored display choices for values: expanded parts, and the format of numbers and records. */

import { type ReadonlySignal, signal } from "@preact/signals-core";
import { BROWSER_STORE, kept } from "../../../store/local_store.ts";

/** Display format of a value. */
export type ValueForm = "list" | "table" | "image" | "plot";

const KEY = "rafcon.value.forms";

type Forms = Readonly<Record<string, ValueForm>>;

const chosen = signal<Forms>(kept<Forms>(BROWSER_STORE, KEY) ?? {});

export const forms: ReadonlySignal<Forms> = chosen;

/** Stores the format for all values of this kind. */
export function chooseForm(kind: string, form: ValueForm): void {
  chosen.value = { ...chosen.peek(), [kind]: form };
  BROWSER_STORE.put(KEY, chosen.peek());
}

const OPEN_MAX = 500;
const open = new Map<string, ReadonlySet<string>>();

/** Parts of a value that were expanded at its last display. */
export function openParts(keep: string): ReadonlySet<string> | undefined {
  return open.get(keep);
}

export function keepOpen(keep: string, parts: ReadonlySet<string>): void {
  open.delete(keep);
  open.set(keep, parts);
  if (open.size <= OPEN_MAX) return;
  for (const oldest of open.keys()) {
    open.delete(oldest);
    return;
  }
}
