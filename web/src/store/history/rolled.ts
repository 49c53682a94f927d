/** Shortens a long journal to its newest events, with a summary of the earlier ones. */

import type {
  ActiveSince,
  EarlierHistory,
  EarlierState,
  EndTime,
  Event,
  HistoryEntry,
} from "../../model/generated/protocol.ts";
import { ABORTED } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";
import { ENTERED, Journal, type JournalBase, LEFT, OTHER } from "./journal.ts";
import { lengthsOf } from "./lengths.ts";

/** Capacity of notable earlier events; the newest are kept. */
const NOTABLE_MAX = 5_000;

const NOTABLE: ReadonlySet<Event["type"]> = new Set([
  "hit",
  "breakpoint_set",
  "breakpoint_removed",
  "forced",
  "root",
  "commanded",
  "asked",
  "closed",
  "deadline_passed",
  "cut_off",
  "resumed",
  "went_back",
  "damaged",
]);

/** The journal's events with another summary of the earlier ones. */
export function withBase(journal: Journal, base: JournalBase): Journal {
  const other = new Journal(base);
  other.add(entriesFrom(journal, journal.first), journal.next);
  return other;
}

/** A journal with the newest events only. */
export function rolled(journal: Journal, newest: number): Journal {
  const cut = Math.max(journal.first, journal.length - newest);
  const before = {
    sequence: journal.sequence(cut) - 1,
    t_ns: journal.t_ns(Math.max(0, cut - 1)),
    active: activeBefore(journal, cut),
  };
  const other = new Journal({ before, earlier: earlierThan(journal, cut, before.sequence) });
  other.add(entriesFrom(journal, cut), journal.next);
  return other;
}

function entriesFrom(journal: Journal, index: number): readonly HistoryEntry[] {
  const entries: HistoryEntry[] = [];
  for (let at = index; at < journal.length; at += 1) {
    const entry = entryAt(journal, at);
    if (entry) entries.push(entry);
  }
  return entries;
}

function entryAt(journal: Journal, index: number): HistoryEntry | null {
  const [sequence, t_ns] = [journal.sequence(index), journal.t_ns(index)];
  const event = eventAt(journal, index);
  return event ? { sequence, t_ns, event } : null;
}

function eventAt(journal: Journal, index: number): Event | undefined {
  if (journal.kind(index) === OTHER) return journal.other(index);
  const path = journal.pathOf(journal.pathNumber(index));
  const undoes = journal.isBack(index) ? 1 : null;
  const outcome = journal.outcome(index);
  if (journal.kind(index) === ENTERED || !outcome) return { type: "entered", path, undoes };
  const error = journal.error(index) ?? (journal.hasError(index) ? "" : null);
  return { type: "left", path, undoes, outcome, error };
}

function activeBefore(journal: Journal, cut: number): ActiveSince[] {
  const active = new Map<string, ActiveSince>();
  for (let index = 0; index < cut; index += 1) {
    const kind = journal.kind(index);
    if (kind === OTHER) {
      const event = index < journal.first ? undefined : journal.other(index);
      if (event?.type === "resumed") active.clear();
      else if (event?.type === "dropped") active.delete(event.path);
      continue;
    }
    const path = journal.pathOf(journal.pathNumber(index));
    active.delete(path);
    const [sequence, t_ns] = [journal.sequence(index), journal.t_ns(index)];
    if (kind === ENTERED) active.set(path, { path, sequence, t_ns });
  }
  // A state without an active parent was dropped along with it.
  const isWhole = (path: string): boolean => {
    const around = parentOf(path);
    return around === null || (active.has(around) && isWhole(around));
  };
  return [...active.values()].filter(({ path }) => isWhole(path));
}

type StateDraft = { -readonly [K in keyof EarlierState]: EarlierState[K] };

/** Null while the history before the journal is unknown. */
function earlierThan(journal: Journal, cut: number, sequence: number): EarlierHistory | null {
  const { base } = journal;
  if (base && !base.earlier) return null;
  const states = new Map<string, StateDraft>();
  for (const state of base?.earlier?.states ?? []) states.set(state.path, { ...state });
  const notable = [...(base?.earlier?.notable ?? [])];
  for (let index = journal.first; index < cut; index += 1) {
    if (journal.kind(index) !== OTHER) count(journal, index, states);
    const entry = isNotable(journal, index) ? entryAt(journal, index) : null;
    if (entry) notable.push(entry);
  }
  return { sequence, states: [...states.values()], notable: notable.slice(-NOTABLE_MAX) };
}

function count(journal: Journal, index: number, states: Map<string, StateDraft>): void {
  const path = journal.pathOf(journal.pathNumber(index));
  const state = states.get(path) ?? {
    path,
    entries: 0,
    ends: 0,
    total_ns: 0,
    min_ns: 0,
    max_ns: 0,
    entered: null,
    left: null,
  };
  states.set(path, state);
  const turn = { sequence: journal.sequence(index), t_ns: journal.t_ns(index) };
  const isBack = journal.isBack(index);
  if (journal.kind(index) === ENTERED) {
    if (!isBack) state.entries += 1;
    state.entered = turn;
    return;
  }
  const outcome = journal.outcome(index);
  if (isBack || !outcome) return;
  const length = lengthsOf(journal).at(index);
  state.left = { ...turn, outcome } satisfies EndTime;
  state.min_ns = state.ends === 0 ? length : Math.min(state.min_ns, length);
  state.max_ns = Math.max(state.max_ns, length);
  state.total_ns += length;
  state.ends += 1;
}

function isNotable(journal: Journal, index: number): boolean {
  if (journal.kind(index) === LEFT) {
    const isFailed = journal.outcome(index)?.id === ABORTED || journal.hasError(index);
    return isFailed && !journal.isBack(index);
  }
  const event = journal.kind(index) === OTHER ? journal.other(index) : undefined;
  if (event?.type === "log") return event.level === "warning" || event.level === "error";
  return event !== undefined && NOTABLE.has(event.type);
}
