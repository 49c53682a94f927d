/** Index of a machine's states by name, fast enough for a search at each keystroke: lower-case names and parents in flat lists.
 * Words may match the state's own name or those of outer states. Objects are created only for results. */

import type { Machine } from "./machine.ts";

interface FoundState {
  readonly path: string;
  /** From 0 to 1; higher is better. */
  readonly score: number;
}

const EXACT = 1;
const BEGINS_TEXT = 0.9;
const BEGINS_WORD = 0.8;
const INSIDE = 0.6;
const AROUND = 0.45;
const SCATTERED = 0.35;
/** Greatest bonus for a short name among equal matches. */
const SHORT = 0.04;

const INDEXES = new WeakMap<Machine, StateIndex>();

/** Index of the current machine: created on first use, and again after a change. */
export function stateIndex(machine: Machine): StateIndex {
  const known = INDEXES.get(machine);
  if (known?.version === machine.version) return known;
  const index = new StateIndex(machine);
  INDEXES.set(machine, index);
  return index;
}

class StateIndex {
  readonly version: number;
  readonly #paths: string[] = [];
  readonly #names: string[] = [];
  /** Index of the state around each state, which precedes it; -1 for the root. */
  readonly #around: number[] = [];

  constructor(machine: Machine) {
    this.version = machine.version;
    const pending: (readonly [string, number])[] = [[machine.root, -1]];
    for (let next = pending.pop(); next; next = pending.pop()) {
      const [path, around] = next;
      const state = machine.state(path);
      if (!state) continue;
      const at = this.#paths.push(path) - 1;
      this.#names.push(state.name.toLowerCase());
      this.#around.push(around);
      const children = machine.children(path);
      for (let child = children.length - 1; child >= 0; child -= 1) {
        pending.push([children[child] ?? "", at]);
      }
    }
  }

  /** Best matches, at most `count`. */
  find(query: string, count: number): readonly FoundState[] {
    const words = query.toLowerCase().split(/\s+/).filter(Boolean).slice(0, WORDS_MAX);
    if (words.length === 0) return [];
    const best = new BestStates(count);
    this.#byWords(words, best);
    if (best.length < count) this.#scattered(words, best);
    return best.all().map(({ at, score }) => ({ path: this.#paths[at] ?? "", score }));
  }

  #byWords(words: readonly string[], best: BestStates): void {
    const all = (1 << words.length) - 1;
    const masks = new Uint8Array(this.#names.length);
    for (let at = 0; at < this.#names.length; at += 1) {
      const name = this.#names[at] ?? "";
      let mask = 0;
      for (let word = 0; word < words.length; word += 1) {
        if (name.includes(words[word] ?? "")) mask |= 1 << word;
      }
      const around = this.#around[at] ?? -1;
      const outer = around < 0 ? 0 : (masks[around] ?? 0);
      masks[at] = mask | outer;
      if ((mask | outer) !== all) continue;
      best.add(at, (mask === all ? scoreOf(words, name) : AROUND) + short(name));
    }
  }

  /** Adds names that contain the letters in order. Names with whole words were added before. */
  #scattered(words: readonly string[], best: BestStates): void {
    const letters = words.join("");
    for (let at = 0; at < this.#names.length; at += 1) {
      const name = this.#names[at] ?? "";
      if (isScattered(letters, name)) best.add(at, SCATTERED + short(name));
    }
  }
}

/** Greatest number of words; each is one bit of a mask. */
const WORDS_MAX = 8;

function scoreOf(words: readonly string[], name: string): number {
  if (words.join(" ") === name) return EXACT;
  let worst = 1;
  for (const word of words) {
    const at = name.indexOf(word);
    const score = at === 0 ? BEGINS_TEXT : beginsWord(name, word, at) ? BEGINS_WORD : INSIDE;
    worst = Math.min(worst, score);
  }
  return worst;
}

function beginsWord(name: string, word: string, first: number): boolean {
  for (let at = first; at >= 0; at = name.indexOf(word, at + 1)) {
    const before = name.charCodeAt(at - 1);
    // Neither a letter nor a digit.
    if (before < 48 || (before > 57 && before < 97) || (before > 122 && before < 128)) return true;
  }
  return false;
}

function short(name: string): number {
  return SHORT / (1 + name.length);
}

function isScattered(letters: string, name: string): boolean {
  let at = -1;
  for (let index = 0; index < letters.length; index += 1) {
    at = name.indexOf(letters[index] ?? "", at + 1);
    if (at < 0) return false;
  }
  return true;
}

/** The best added states, without sorting all of them. */
class BestStates {
  readonly #count: number;
  #kept: { readonly at: number; readonly score: number }[] = [];
  readonly #known = new Set<number>();
  #least = Number.NEGATIVE_INFINITY;

  constructor(count: number) {
    this.#count = count;
  }

  get length(): number {
    return Math.min(this.#count, this.#kept.length);
  }

  add(at: number, score: number): void {
    if (score <= this.#least || this.#known.has(at)) return;
    this.#known.add(at);
    this.#kept.push({ at, score });
    if (this.#kept.length >= 4 * this.#count) this.#cut();
  }

  all(): readonly { readonly at: number; readonly score: number }[] {
    this.#cut();
    return this.#kept;
  }

  #cut(): void {
    this.#kept.sort((one, other) => other.score - one.score || one.at - other.at);
    this.#kept = this.#kept.slice(0, this.#count);
    if (this.#kept.length === this.#count) this.#least = this.#kept.at(-1)?.score ?? this.#least;
  }
}
