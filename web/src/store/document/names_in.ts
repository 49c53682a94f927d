/** Puts the names of states in the place of their paths in what is said to people, also of those that somebody has taken away. */

interface Gone {
  readonly name: string;
  readonly who: string;
}

/** So many are remembered, the last ones. */
const REMEMBERED = 1_000;
/** With a slash, or the id of a root alone. */
const PATH = /[^\s:,;.“”"]*\/[^\s:,;.“”"]*|\b[A-Z]{6}\b/g;
const SOMEBODY = "someone may have removed it";

export class GoneStates {
  readonly #gone = new Map<string, Gone>();

  /** Remembers a state that was taken away, and who did it. */
  note(path: string, name: string, who: string): void {
    this.#gone.delete(path);
    this.#gone.set(path, { name, who });
    for (const oldest of this.#gone.keys()) {
      if (this.#gone.size <= REMEMBERED) break;
      this.#gone.delete(oldest);
    }
  }

  /** The text with names; `alive` tells those of states that are there. */
  named(text: string, alive: (path: string) => string | undefined): string {
    let who: string | null = null;
    const named = text.replace(PATH, (path) => {
      const there = alive(path);
      if (there !== undefined) return `“${there}”`;
      const gone = this.#gone.get(path);
      if (!gone) return path;
      who = gone.who;
      return `“${gone.name}”`;
    });
    if (who === null) return named;
    const by = `${who} removed it`;
    return named.includes(SOMEBODY) ? named.replace(SOMEBODY, by) : `${named} (${by})`;
  }
}

/** The same where nothing is ever taken away. */
export function withNames(text: string, alive: (path: string) => string | undefined): string {
  return new GoneStates().named(text, alive);
}
