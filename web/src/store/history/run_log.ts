/** The log of a run, read from its journal as that grows; older lines than the journal has are asked for at the server. */

import type { LogLevel, LogLine, LogPage, Stream } from "../../model/generated/protocol.ts";
import { perOwner } from "../../model/per_owner.ts";
import { type Journal, OTHER } from "./journal.ts";
import type { Runs, Watch } from "./run.ts";

export interface RunLogLine {
  readonly sequence: number;
  readonly t_ns: number;
  /** The state that wrote it; empty if none did. */
  readonly path: string;
  readonly level: LogLevel;
  readonly stream: Stream;
  readonly message: string;
}

/** So many lines are kept, and those that were asked for beside; then all but the newest half go, and can be asked for again. */
const LINES_MAX = 30_000;
/** So many events are looked through for older lines at first, then twice as many, until so many lines are found. */
const OLDER_EVENTS = 5_000;
const OLDER_LINES = 100;
const PAGE = 1_000;

export class RunLog {
  readonly #watch: Pick<Watch, "id" | "journal">;
  #lines: RunLogLine[] = [];
  #journal: Journal;
  #index: number;
  #from: number;
  /** The first event that was not read. */
  #next = 1;
  #age = 0;
  /** How many of the lines were asked for. */
  #asked = 0;

  constructor(watch: Pick<Watch, "id" | "journal">) {
    this.#watch = watch;
    this.#journal = watch.journal;
    this.#index = this.#journal.first;
    this.#from = this.#journal.from;
  }

  /** Those that are here, the oldest first. The list grows. */
  get lines(): readonly RunLogLine[] {
    return this.#lines;
  }

  /** All lines from this event on are here. */
  get from(): number {
    return this.#from;
  }

  /** Another number whenever the lines are others than before, and not only more. */
  get age(): number {
    return this.#age;
  }

  /** Goes on to the end of the journal. */
  update(): void {
    const { journal } = this.#watch;
    if (journal !== this.#journal) this.#goOnIn(journal);
    for (; this.#index < journal.length; this.#index += 1) {
      if (journal.kind(this.#index) === OTHER) this.#take(this.#index);
    }
    this.#next = journal.next;
    if (this.#lines.length > LINES_MAX + this.#asked) this.#forget();
  }

  /** Asks for lines before those that are here. Throws a `RefusalError`. */
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

  /** Goes on after the last event that was read, or anew behind a gap. */
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

  /** An event that may have been a line is gone already: there is no gap between lines that are here. */
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

/** The log of a run around the moment that is shown, the same for all who ask: its end, or that of an earlier part. */
export function runLog(watch: Watch): RunLog {
  const { id, window, journal } = watch;
  return window === journal ? newestLog(watch) : pastLog(window, id);
}

const newestLog = perOwner((watch: Watch) => new RunLog(watch));
const pastLog = perOwner((journal: Journal, id: string) => new RunLog({ id, journal }));
