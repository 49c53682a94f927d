/** Statistics of states up to an event: number of ends, durations and outcomes. They match the server's statistics of a whole run.
 * Only the ends between the last request and this one are processed. */

import type { Outcome, StateStatistics } from "../../model/generated/protocol.ts";
import { perOwner } from "../../model/per_owner.ts";
import { lowerBound } from "./column.ts";
import { type Journal, LEFT } from "./journal.ts";
import { lengthsOf } from "./lengths.ts";

/** Without names, which come from the machine. */
type StatisticsUntil = Omit<StateStatistics, "names">;

/** Rows of all states that had ended before the event with this index, in the order of their first end. Unchanged rows keep their
 * object. */
export function statisticsUntil(journal: Journal, index: number): readonly StatisticsUntil[] {
  return endsOf(journal).until(index);
}

class StateEnds {
  readonly #journal: Journal;
  readonly #states = new Map<number, State>();
  #next: number;

  constructor(journal: Journal) {
    this.#journal = journal;
    this.#next = journal.first;
  }

  until(index: number): readonly StatisticsUntil[] {
    this.#catchUp();
    const rows: StatisticsUntil[] = [];
    for (const state of this.#states.values()) {
      const row = state.until(index);
      if (row) rows.push(row);
    }
    return rows;
  }

  #catchUp(): void {
    const journal = this.#journal;
    for (; this.#next < journal.length; this.#next += 1) {
      if (journal.kind(this.#next) !== LEFT || journal.isBack(this.#next)) continue;
      const number = journal.pathNumber(this.#next);
      const state = this.#states.get(number) ?? new State(journal, journal.pathOf(number));
      this.#states.set(number, state);
      state.ends.push(this.#next);
    }
  }
}

type SortedLengths = Float64Array<ArrayBuffer>;

class State {
  /** Indices in the journal, ascending. */
  readonly ends: number[] = [];
  readonly #journal: Journal;
  readonly #path: string;
  readonly #outcomes = new Map<number, { outcome: Outcome; count: number }>();
  /** Durations of the counted ends, ascending; the array may have spare capacity. */
  #sorted = new Float64Array(0);
  #count = 0;
  #total_ns = 0;
  #row: StatisticsUntil | null = null;

  constructor(journal: Journal, path: string) {
    this.#journal = journal;
    this.#path = path;
  }

  /** Null if the state had not ended. */
  until(index: number): StatisticsUntil | null {
    const count = lowerBound(this.ends.length, (place) => (this.ends[place] ?? 0) < index);
    if (count !== this.#count) this.#to(count);
    return this.#row;
  }

  #to(count: number): void {
    const isMore = count > this.#count;
    const ends = this.ends.slice(Math.min(count, this.#count), Math.max(count, this.#count));
    const lengths = Float64Array.from(ends, (end) => lengthsOf(this.#journal).at(end)).sort();
    for (const end of ends) this.#tally(end, isMore ? 1 : -1);
    if (isMore) this.#sorted = merged(this.#sorted, this.#count, lengths);
    else leaveOut(this.#sorted, this.#count, lengths);
    this.#count = count;
    this.#row = count === 0 ? null : this.#summarize();
  }

  #tally(end: number, by: 1 | -1): void {
    this.#total_ns += by * lengthsOf(this.#journal).at(end);
    const outcome = this.#journal.outcome(end);
    if (!outcome) return;
    const known = this.#outcomes.get(outcome.id) ?? { outcome, count: 0 };
    this.#outcomes.set(outcome.id, known);
    known.count += by;
  }

  #summarize(): StatisticsUntil {
    const [count, sorted] = [this.#count, this.#sorted];
    const at = (percent: number) => sorted[Math.ceil((count * percent) / 100) - 1] ?? 0;
    const outcomes = [...this.#outcomes.values()].filter(({ count: often }) => often > 0);
    outcomes.sort((one, other) => other.count - one.count || one.outcome.id - other.outcome.id);
    return {
      path: this.#path,
      count,
      total_ns: this.#total_ns,
      min_ns: sorted[0] ?? 0,
      median_ns: at(50),
      p95_ns: at(95),
      max_ns: sorted[count - 1] ?? 0,
      outcomes: outcomes.map((often) => ({ ...often })),
    };
  }
}

/** Merges sorted numbers into the first `count` numbers; in place if there is capacity. */
function merged(numbers: SortedLengths, count: number, more: SortedLengths): SortedLengths {
  const all = count + more.length;
  const into = all <= numbers.length ? numbers : new Float64Array(2 * all);
  let [left, right] = [count - 1, more.length - 1];
  for (let at = all - 1; at >= 0; at -= 1) {
    if (right < 0 && into === numbers) break;
    const isLeft = right < 0 || (left >= 0 && (numbers[left] ?? 0) > (more[right] ?? 0));
    into[at] = (isLeft ? numbers[left--] : more[right--]) ?? 0;
  }
  return into;
}

/** Removes sorted numbers from the first `count` numbers, in place. */
function leaveOut(numbers: SortedLengths, count: number, some: SortedLengths): void {
  let [kept, out] = [0, 0];
  for (let at = 0; at < count; at += 1) {
    const number = numbers[at] ?? 0;
    if (out < some.length && number === some[out]) out += 1;
    else numbers[kept++] = number;
  }
}

const endsOf = perOwner((journal: Journal) => new StateEnds(journal));
