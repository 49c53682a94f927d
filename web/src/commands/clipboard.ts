/** States on the clipboard: as text, so that they go between machines, browser tabs and files. */

import type { Selection } from "../model/generated/protocol.ts";

/** As much of a drag's or paste's data as is needed. */
export type TextTransfer = Pick<DataTransfer, "getData" | "setData">;

/** What is written while the browser gives no clipboard: other tabs of this browser find it. */
const STAND_IN = "rafcon.clipboard";

export function textOf(selection: Selection): string {
  return JSON.stringify({ rafcon: selection });
}

/** The states in a text; null if it is about something else. */
export function selectionIn(text: string): Selection | null {
  if (!text.trimStart().startsWith("{")) return null;
  try {
    const found = JSON.parse(text) as { rafcon?: Partial<Selection> };
    const selection = found.rafcon;
    return typeof selection?.container === "string" ? (selection as Selection) : null;
  } catch {
    return null;
  }
}

/** Puts the states onto the clipboard: of the event that asks for them, else of the system. */
export async function write(selection: Selection, transfer: TextTransfer | null): Promise<void> {
  const text = textOf(selection);
  try {
    localStorage.setItem(STAND_IN, text);
  } catch {
    // No room: the system's clipboard has it.
  }
  if (transfer) transfer.setData("text/plain", text);
  else await navigator.clipboard?.writeText(text).catch(() => undefined);
}

/** The states on the clipboard; null if there is something else. */
export async function read(transfer: TextTransfer | null): Promise<Selection | null> {
  if (transfer) return selectionIn(transfer.getData("text/plain"));
  const text = await navigator.clipboard?.readText().catch(() => undefined);
  return selectionIn(text ?? localStorage.getItem(STAND_IN) ?? "");
}

/** The data of an event that a command was run with, if it was. */
export function transferOf(argument: unknown): TextTransfer | null {
  const isTransfer = typeof argument === "object" && argument !== null && "getData" in argument;
  return isTransfer ? (argument as TextTransfer) : null;
}
