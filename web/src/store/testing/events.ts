/** Events for tests: from short text, or random as in a run. */

import type { Event, HistoryEntry } from "../../model/generated/protocol.ts";

/** Events as short text, one per line, one ms apart: `> R/A` is an entry, `< R/A done` an end, `< R/A done: words` an end with an
 * error, both with `!` after the path for a step back; `x R/A` is a drop, `= R/A words` a log line, `! R/A words` a warning,
 * `crash` a restart after the runner died. */
export function events(text: string): readonly HistoryEntry[] {
  return text
    .trim()
    .split("\n")
    .map((line, index) => {
      const [what = "", path = "", ...words] = line.trim().split(" ");
      return {
        sequence: index + 1,
        t_ns: (index + 1) * 1_000_000,
        event: eventOf(what, path, words.join(" ")),
      };
    });
}

const ENDS: Readonly<Record<string, number>> = { aborted: -1, preempted: -2 };

function eventOf(what: string, path: string, words: string): Event {
  const undoes = path.endsWith("!") ? 1 : null;
  const at = path.replace("!", "");
  switch (what) {
    case ">":
      return { type: "entered", path: at, undoes };
    case "<": {
      const [name = "", error] = (words || "done").split(": ");
      const outcome = { id: ENDS[name] ?? 0, name };
      return { type: "left", path: at, undoes, outcome, ...(error === undefined ? {} : { error }) };
    }
    case "x":
      return { type: "dropped", path: at };
    case "crash": {
      const crash = { reason: "killed", active: [] };
      return { type: "resumed", life: 2, crash, policy: "restart" };
    }
    default: {
      const level = what === "!" ? "warning" : "info";
      return { type: "log", path: at, level, stream: "stdout", message: words };
    }
  }
}

/** Random numbers below one, determined by the seed. */
export function random(seed: number): () => number {
  let state = seed * 2_654_435_761 + 1;
  return () => {
    state = (Math.imul(state ^ (state >>> 15), 0x2c1b3c6d) + 0x9e3779b9) | 0;
    const mixed = Math.imul(state ^ (state >>> 13), 0x297a2d39);
    return ((mixed ^ (mixed >>> 16)) >>> 0) / 2 ** 32;
  };
}

/** Events of a random run of a machine with hierarchies (H) and concurrency (C), at least `many` of them. Sometimes states fail, or
 * the runner dies and resumes. */
export function randomRun(seed: number, many: number): readonly HistoryEntry[] {
  const run = new RandomRun(random(seed));
  run.enter("R");
  while (run.lines.length < many) run.go();
  return events(run.lines.join("\n"));
}

const DEEPEST = 6;

class RandomRun {
  readonly lines: string[] = [];
  readonly #open: string[] = [];
  readonly #chance: () => number;

  constructor(chance: () => number) {
    this.#chance = chance;
  }

  enter(path: string): void {
    this.lines.push(`> ${path}`);
    this.#open.push(path);
  }

  go(): void {
    const path = this.#open[Math.floor(this.#chance() * this.#open.length)] ?? "R";
    if (this.#chance() < 0.01) this.#crash();
    else if (this.#chance() < 0.05) this.lines.push(`! ${path} careful`);
    else if (!this.#open.some((other) => other.startsWith(`${path}/`))) this.#goOn(path);
  }

  /** Enters a state inside an idle state, or leaves that state. */
  #goOn(path: string): void {
    const isContainer = /[RHC]$/.test(path) && path.split("/").length < DEEPEST;
    if (path !== "R" && !(isContainer && this.#chance() < 0.6)) this.#leave(path);
    else if (path.endsWith("C")) for (const name of "ABH") this.enter(`${path}/${name}`);
    else this.enter(`${path}/${"ABCH"[Math.floor(this.#chance() * 4)]}`);
  }

  #leave(path: string): void {
    const outcome = ["aborted", "preempted"][Math.floor(this.#chance() * 10)] ?? "done";
    this.lines.push(`< ${path} ${outcome}`);
    this.#open.splice(this.#open.indexOf(path), 1);
  }

  #crash(): void {
    this.lines.push("crash");
    for (const path of this.#open.splice(0).sort()) this.enter(path);
  }
}
