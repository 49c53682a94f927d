/** How values are shown, as the user left it: which of their parts are open, and in which form numbers and records stand. */

import { type ReadonlySignal, signal } from "@preact/signals-core";

/** Which form of a value is shown where there are several. */
export type ValueForm = "list" | "table" | "image" | "plot";

const KEY = "rafcon.value.forms";

type Forms = Readonly<Record<string, ValueForm>>;

const chosen = signal<Forms>(remembered());

export const forms: ReadonlySignal<Forms> = chosen;

/** Shows values of this kind in this form from now on. */
export function chooseForm(kind: string, form: ValueForm): void {
  chosen.value = { ...chosen.peek(), [kind]: form };
  try {
    globalThis.localStorage?.setItem(KEY, JSON.stringify(chosen.peek()));
  } catch {
    // Without storage it lasts as long as the page.
  }
}

function remembered(): Forms {
  try {
    const found: unknown = JSON.parse(globalThis.localStorage?.getItem(KEY) ?? "{}");
    return typeof found === "object" && found !== null ? (found as Forms) : {};
  } catch {
    return {};
  }
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
