/** How values are shown, as the user left it: which of their parts are open, and in which form numbers and records stand. */

import { type ReadonlySignal, signal } from "@preact/signals-core";
import { BROWSER_STORE, kept } from "../../../store/local_store.ts";

/** Which form of a value is shown where there are several. */
export type ValueForm = "list" | "table" | "image" | "plot";

const KEY = "rafcon.value.forms";

type Forms = Readonly<Record<string, ValueForm>>;

const chosen = signal<Forms>(kept<Forms>(BROWSER_STORE, KEY) ?? {});

export const forms: ReadonlySignal<Forms> = chosen;

/** Shows values of this kind in this form from now on. */
export function chooseForm(kind: string, form: ValueForm): void {
  chosen.value = { ...chosen.peek(), [kind]: form };
  BROWSER_STORE.put(KEY, chosen.peek());
}

const OPEN_MAX = 500;
const open = new Map<string, ReadonlySet<string>>();

/** The parts of a value that were open when it was seen last. */
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
