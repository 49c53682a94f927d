/** Command for a list as an operator enters it: its kind, the time of its effect, and its expiry. */

import type { Command, ListedCommand, ListTime } from "../../model/generated/protocol.ts";
import { UTC_HINT, utcEntered, utcText } from "./utc_entry.ts";

/** Commands without a further value, and any other one as JSON. */
export const ENTRY_KINDS = [
  { value: "pause", title: "Pause" },
  { value: "resume", title: "Resume" },
  { value: "stop", title: "Stop" },
  { value: "kill", title: "Kill" },
  { value: "json", title: "Other, as JSON" },
] as const;

export type EntryKind = (typeof ENTRY_KINDS)[number]["value"];

export type EntryTime = "none" | "utc" | "contact";

/** Fields of the form. */
export interface ListEntry {
  readonly kind: EntryKind;
  /** Command for the kind `json`. */
  readonly json: string;
  readonly effect: EntryTime;
  /** Time in UTC, or seconds after the start of the contact. */
  readonly effectText: string;
  readonly expiry: EntryTime;
  readonly expiryText: string;
}

export const EMPTY_ENTRY: ListEntry = {
  kind: "pause",
  json: "",
  effect: "none",
  effectText: "",
  expiry: "none",
  expiryText: "",
};

/** Command for the list of a robot, or the fault of the form. The station checks everything else. */
export function listedCommand(
  entry: ListEntry,
  run: string,
  contact_ms: number | undefined,
): ListedCommand | { readonly fault: string } {
  const command = commandOf(entry);
  if (typeof command === "string") return { fault: command };
  const not_before = timeOf(entry.effect, entry.effectText, contact_ms);
  if (not_before && "fault" in not_before) return { fault: `Takes effect: ${not_before.fault}` };
  const expiry = timeOf(entry.expiry, entry.expiryText, contact_ms);
  if (expiry && "fault" in expiry) return { fault: `Expires: ${expiry.fault}` };
  return {
    run,
    command,
    ...(not_before && { not_before: not_before.time }),
    ...(expiry && { expiry: expiry.time }),
  };
}

/** Command, or the reason why it is invalid. */
function commandOf({ kind, json }: ListEntry): Command | string {
  if (kind === "resume") return { type: "resume", branch: null };
  if (kind !== "json") return { type: kind };
  try {
    const value: unknown = JSON.parse(json);
    if (typeof value === "object" && value !== null && "type" in value) return value as Command;
  } catch {
    // The parser's message is of little use for such a short text.
  }
  return 'Command: write an object with a type, such as {"type": "step_mode"}';
}

/** Time of a field, or its fault; null for no time. */
function timeOf(
  kind: EntryTime,
  text: string,
  contact_ms: number | undefined,
): { readonly time: ListTime } | { readonly fault: string } | null {
  if (kind === "none") return null;
  if (kind === "contact") {
    const after_s = Number(text);
    if (contact_ms === undefined) return { fault: "no contact is planned" };
    const isNumber = text.trim() !== "" && Number.isFinite(after_s) && after_s >= 0;
    return isNumber
      ? { time: { contact: utcText(contact_ms), after_s } }
      : { fault: "enter seconds after the begin of the contact, such as 30" };
  }
  const at_ms = utcEntered(text);
  return at_ms === null ? { fault: UTC_HINT } : { time: utcText(at_ms) };
}
