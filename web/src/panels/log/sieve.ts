/** Lines of a run's log that pass the filter. The filter runs once per line as the log grows. */

import type { RunLog } from "../../store/history/run_log.ts";
import { isWanted, type LogEntry, type LogSelection, lineEntry } from "./entries.ts";

export class Sieve {
  readonly #log: RunLog;
  readonly #selection: LogSelection;
  readonly #began_ms: number;
  readonly #nameOf: (path: string) => string;
  #kept: readonly LogEntry[] = [];
  #count = 0;
  #age = 0;

  constructor(
    log: RunLog,
    selection: LogSelection,
    began_ms: number,
    nameOf: (path: string) => string,
  ) {
    this.#log = log;
    this.#selection = selection;
    this.#began_ms = began_ms;
    this.#nameOf = nameOf;
    this.#age = log.age;
  }

  /** Lines that passed until now. Returns the cached list while no line is added. */
  rows(): readonly LogEntry[] {
    this.#log.update();
    if (this.#log.age !== this.#age) {
      [this.#kept, this.#count, this.#age] = [[], 0, this.#log.age];
    }
    const { lines } = this.#log;
    const fresh: LogEntry[] = [];
    for (; this.#count < lines.length; this.#count += 1) {
      const line = lines[this.#count];
      const entry = line && lineEntry(line, this.#began_ms);
      if (entry && isWanted(entry, this.#selection, this.#nameOf)) fresh.push(entry);
    }
    if (fresh.length > 0) this.#kept = this.#kept.concat(fresh);
    return this.#kept;
  }
}
