/** Lines of the log from all sources: filter and order. */

import type { LogLevel } from "../../model/generated/protocol.ts";
import { isWithin } from "../../model/path.ts";
import { readTraceback } from "../../model/traceback.ts";
import type { RunLogLine } from "../../store/history/run_log.ts";
import { noticeText } from "../../store/page/notices.ts";
import type { Notice } from "../../store/page/page.ts";

export interface LogEntry {
  readonly id: string;
  readonly at_ms: number;
  readonly level: LogLevel;
  readonly text: string;
  /** Subject and suggested action of a line from the page. */
  readonly about?: Notice["about"];
  readonly action?: Notice["action"];
  /** Original line of a run. */
  readonly line?: RunLogLine;
}

export const SOURCES = ["both", "run", "page"] as const;
export type LogSource = (typeof SOURCES)[number];

export interface LogSelection {
  /** Lowest level that passes the filter. */
  readonly least: LogLevel;
  /** Text that the line or the name of its state must contain, ignoring case. */
  readonly query: string;
  /** States that lines must belong to, including states inside; null for all lines. */
  readonly states: readonly string[] | null;
}

export function entryOf(notice: Notice): LogEntry {
  const { id, at_ms, level, about, action } = notice;
  return { id: `page ${id}`, at_ms, level, text: noticeText(notice), about, action };
}

/** Entry for a line of a run. `began_ms` is the start of the run by this browser's clock. */
export function lineEntry(line: RunLogLine, began_ms: number): LogEntry {
  const at_ms = began_ms + line.t_ns / 1e6;
  return { id: `run ${line.sequence}`, at_ms, level: line.level, text: line.message, line };
}

/** Levels in rising order. */
const LEVELS: readonly LogLevel[] = ["verbose", "debug", "info", "warning", "error"];

/** True if a line passes the filter; `nameOf` returns the name of a state. */
export function isWanted(
  { level, text, line, about }: LogEntry,
  { least, query, states }: LogSelection,
  nameOf: (path: string) => string,
): boolean {
  if (LEVELS.indexOf(level) < LEVELS.indexOf(least)) return false;
  const path = line?.path ?? about?.element.path;
  if (states && !(path && states.some((outer) => isWithin(path, outer)))) return false;
  const wanted = query.trim().toLowerCase();
  if (wanted === "" || text.toLowerCase().includes(wanted)) return true;
  return line !== undefined && nameOf(line.path).toLowerCase().includes(wanted);
}

/** Merges two lists that are sorted by time. */
export function merged(one: readonly LogEntry[], other: readonly LogEntry[]): readonly LogEntry[] {
  if (one.length === 0) return other;
  if (other.length === 0) return one;
  const all: LogEntry[] = [];
  let at = 0;
  for (const entry of one) {
    for (let next = other[at]; next && next.at_ms < entry.at_ms; next = other[at]) {
      all.push(next);
      at += 1;
    }
    all.push(entry);
  }
  return all.concat(other.slice(at));
}

/** Shortens a text to one line: the exception and script line of a traceback, else the first line and the number of lines. */
export function inOneLine(text: string): string {
  const end = text.indexOf("\n");
  if (end < 0) return text;
  const traceback = readTraceback(text);
  if (traceback) {
    const { own, message } = traceback;
    const before = text.startsWith("Traceback") ? "" : `${text.slice(0, end)} — `;
    return `${before}${message.split("\n")[0]}${own ? ` — script.py line ${own.line}` : ""}`;
  }
  const count = text.split("\n").length;
  return `${text.slice(0, end)} … ${count} lines`;
}
