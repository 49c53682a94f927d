/** The clipboard as text, so that states, ports and outcomes go between machines, browser tabs and files. */

import type { ElementRef } from "../model/element.ts";
import type { Selection } from "../model/generated/protocol.ts";
import type { Machine } from "../model/machine.ts";
import { type Clip, type CopiedWaypoints, clipOf } from "../plan/clipboard.ts";
import type { InterfacePart } from "../plan/parts.ts";
import { isRefused } from "../plan/plan.ts";
import { BROWSER_STORE, kept } from "../store/local_store.ts";
import type { TextTransfer } from "../store/page/command_arguments.ts";

/** Storage key of copies while the browser grants no clipboard. Other tabs of this browser read it. */
const STAND_IN = "rafcon.clipboard";

/** Content of the text: the payload of an edit, and the additions of this page. */
interface ClipboardText {
  readonly rafcon?: Partial<Selection> | null;
  readonly ways?: CopiedWaypoints;
  readonly parts?: readonly InterfacePart[];
}

function writtenOf({ selection, ways: waypoints, parts }: Clip): ClipboardText {
  return {
    rafcon: selection,
    ...(waypoints ? { ways: waypoints } : {}),
    ...(parts.length > 0 ? { parts } : {}),
  };
}

export function textOf(clip: Clip): string {
  return JSON.stringify(writtenOf(clip));
}

/** Parses a text with parts of machines; null for any other text. */
export function clipIn(text: string): Clip | null {
  if (!text.trimStart().startsWith("{")) return null;
  try {
    return clipOfWritten(JSON.parse(text));
  } catch {
    return null;
  }
}

function clipOfWritten({ rafcon, ways: waypoints, parts }: ClipboardText): Clip | null {
  const selection = typeof rafcon?.container === "string" ? (rafcon as Selection) : null;
  const known = Array.isArray(parts) ? parts.filter(isPart) : [];
  return selection || known.length > 0 ? { selection, ways: waypoints, parts: known } : null;
}

const PORTS: readonly unknown[] = ["input", "output", "scoped_variable"];

function isPart(part: Partial<Record<string, unknown>> | null): part is InterfacePart {
  if (typeof part?.["name"] !== "string") return false;
  const isPort = PORTS.includes(part["kind"]) && typeof part["data_type"] === "string";
  return part["kind"] === "outcome" || isPort;
}

/** Puts it onto the clipboard: of the event that asks for it, else of the system. */
export async function write(clip: Clip, transfer: TextTransfer | null): Promise<void> {
  const text = textOf(clip);
  BROWSER_STORE.put(STAND_IN, writtenOf(clip));
  if (transfer) transfer.setData("text/plain", text);
  else await navigator.clipboard?.writeText(text).catch(() => undefined);
}

/** Copies elements of a machine to the clipboard; reports the reason if that is impossible. */
export async function copyElements(
  machine: Machine,
  elements: readonly ElementRef[],
  transfer: TextTransfer | null,
): Promise<string | null> {
  const clip = clipOf(machine, elements);
  if (isRefused(clip)) return clip.refused;
  await write(clip, transfer);
  return null;
}

/** Message for an empty clipboard. */
export const NOTHING_COPIED =
  "The clipboard has no states, ports or outcomes. Copy some first, here or in another tab.";

/** Content of the clipboard; null if it has no parts of machines. */
export async function read(transfer: TextTransfer | null): Promise<Clip | null> {
  if (transfer) return clipIn(transfer.getData("text/plain"));
  const text = await navigator.clipboard?.readText().catch(() => undefined);
  return text === undefined ? clipOfWritten(kept(BROWSER_STORE, STAND_IN) ?? {}) : clipIn(text);
}
