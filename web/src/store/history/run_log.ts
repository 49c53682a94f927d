/** Log of a run, read from its journal as it grows. Lines older than the journal are requested from the server. */

import type { LogLevel, LogLine, LogPage, Stream } from "../../model/generated/protocol.ts";
import { perOwner } from "../../model/per_owner.ts";
import { type Journal, OTHER } from "./journal.ts";
import type { Runs, Watch } from "./run.ts";

export interface RunLogLine {
  readonly sequence: number;
  readonly t_ns: number;
  /** State that wrote it; empty if none did. */
  readonly path: string;
  readonly level: LogLevel;
  readonly stream: Stream;
  readonly message: string;
}

/** Capacity of the lines, in addition to requested ones. When it is exceeded, only the newest half is kept; older lines can be
 * requested again. */
const LINES_MAX = 30_000;
/** Number of events in the first search for older lines. It doubles until `OLDER_LINES` lines are found. */
const OLDER_EVENTS = 5_000;
const OLDER_LINES = 100;
const PAGE = 1_000;

export class RunLog {
  readonly #watch: Pick<Watch, "id" | "journal">;
  #lines: RunLogLine[] = [];
  #journal: Journal;
  #index: number;
  #from: number;
  /** Sequence number of the first unread event. */
  #next = 1;
  #age = 0;
  /** Number of lines that were requested. */
  #asked = 0;

  constructor(watch: Pick<Watch, "id" | "journal">) {
    this.#watch = watch;
    this.#journal = watch.journal;
    this.#index = this.#journal.first;
    this.#from = this.#journal.from;
  }

  /** The available lines, the oldest first. The list grows in place. */
  get lines(): readonly RunLogLine[] {
    return this.#lines;
  }

  /** Event from which on all lines are available. */
  get from(): number {
    return this.#from;
  }

  /** Changes when lines were replaced, and not only appended. */
  get age(): number {
    return this.#age;
  }

  /** Reads up to the end of the journal. */
  update(): void {
    const { journal } = this.#watch;
    if (journal !== this.#journal) this.#goOnIn(journal);
    for (; this.#index < journal.length; this.#index += 1) {
      if (journal.kind(this.#index) === OTHER) this.#take(this.#index);
    }
    this.#next = journal.next;
    if (this.#lines.length > LINES_MAX + this.#asked) this.#forget();
  }

  /** Requests lines before the available ones. Throws a `RefusalError`. */
  async older(runs: Pick<Runs, "get">): Promise<void> {
    const to = this.#from;
    const found: RunLogLine[] = [];
    let begin = to;
    for (let look = OLDER_EVENTS; found.length < OLDER_LINES && begin > 1; look *= 2) {
      const end = begin;
      begin = Math.max(1, end - look);
      found.unshift(...(await this.#between(begin, end, runs)));
    }
    if (this.#from !== to) return;
    this.#lines = [...found, ...this.#lines];
    this.#from = begin;
    this.#asked += found.length;
    this.#age += 1;
  }

  async #between(
    begin: number,
    end: number,
    runs: Pick<Runs, "get">,
  ): Promise<readonly RunLogLine[]> {
    const found: RunLogLine[] = [];
    for (let next = begin; next < end; ) {
      const page: LogPage = await runs.get(this.#watch.id, `log?from=${next}&count=${PAGE}`);
      found.push(...page.lines.filter(({ sequence }) => sequence < end).map(lineOf));
      if (page.next <= next) break;
      next = page.next;
    }
    return found;
  }

  /** Continues after the last event that was read, or starts again after a gap. */
  #goOnIn(journal: Journal): void {
    this.#journal = journal;
    if (journal.from <= this.#next) {
      this.#index = Math.max(journal.first, journal.indexOf(this.#next));
      return;
    }
    this.#index = journal.first;
    this.#missed(journal.from - 1);
  }

  #take(index: number): void {
    const { journal } = this.#watch;
    const [sequence, event] = [journal.sequence(index), journal.other(index)];
    if (!event) this.#missed(sequence);
    else if (event.type === "log") {
      const { path, level, stream, message } = event;
      const t_ns = journal.t_ns(index);
      this.#lines.push({ sequence, t_ns, path, level, stream, message });
    }
  }

  /** Drops all lines before a missing event, because it may have been a line. There are no gaps between lines. */
  #missed(sequence: number): void {
    if (this.#lines.length > 0) this.#age += 1;
    this.#lines = [];
    this.#asked = 0;
    this.#from = sequence + 1;
  }

  #forget(): void {
    this.#lines = this.#lines.slice(LINES_MAX / 2 + this.#asked);
    this.#asked = 0;
    this.#from = this.#lines[0]?.sequence ?? this.#from;
    this.#age += 1;
  }
}

function lineOf({ sequence, t_ns, path, level, stream, message }: LogLine): RunLogLine {
  return { sequence, t_ns, path, level, stream, message };
}

/** Log of a run around the shown moment, shared by all callers: its newest lines, or those of an earlier part. */
export function runLog(watch: Watch): RunLog {
  const { id, window, journal } = watch;
  return window === journal ? newestLog(watch) : pastLog(window, id);
}

const newestLog = perOwner((watch: Watch) => new RunLog(watch));
const pastLog = perOwner((journal: Journal, id: string) => new RunLog({ id, journal }));
