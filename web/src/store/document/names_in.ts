/** Replaces state paths by names in texts for people, also for removed states. */

interface Gone {
  readonly name: string;
  readonly who: string;
}

/** Capacity of the removed states. The oldest are dropped. */
const REMEMBERED = 1_000;
/** A path with a slash, or the id of a root. */
const PATH = /[^\s:,;.“”"]*\/[^\s:,;.“”"]*|\b[A-Z]{6}\b/g;
const SOMEBODY = "someone may have removed it";

export class GoneStates {
  readonly #gone = new Map<string, Gone>();

  /** Remembers a removed state and who removed it. */
  note(path: string, name: string, who: string): void {
    this.#gone.delete(path);
    this.#gone.set(path, { name, who });
    for (const oldest of this.#gone.keys()) {
      if (this.#gone.size <= REMEMBERED) break;
      this.#gone.delete(oldest);
    }
  }

  /** The text with names. `alive` returns the names of existing states. */
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

/** The text with names, for a machine from which no state is removed. */
export function withNames(text: string, alive: (path: string) => string | undefined): string {
  return new GoneStates().named(text, alive);
}
