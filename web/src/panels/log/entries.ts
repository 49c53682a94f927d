/** Lines of the log, whoever says them. */

import type { LogLevel } from "../../model/generated/protocol.ts";
import type { Notice } from "../../store/page.ts";

export interface Entry {
  readonly id: string;
  readonly at_ms: number;
  readonly level: LogLevel;
  /** Who says it. */
  readonly source: "page";
  readonly text: string;
  readonly about: Notice["about"];
  readonly action: Notice["action"];
}

export function entryOf({ id, at_ms, level, text, about, action }: Notice): Entry {
  return { id: `page ${id}`, at_ms, level, source: "page", text, about, action };
}

/** From the least to the most. */
export const LEVELS: readonly LogLevel[] = ["verbose", "debug", "info", "warning", "error"];

/** Those that matter at least so much and have the text, whatever its case. */
export function filtered(
  entries: readonly Entry[],
  least: LogLevel,
  query: string,
): readonly Entry[] {
  const wanted = query.trim().toLowerCase();
  const from = LEVELS.indexOf(least);
  return entries.filter(
    ({ level, text }) => LEVELS.indexOf(level) >= from && text.toLowerCase().includes(wanted),
  );
}
