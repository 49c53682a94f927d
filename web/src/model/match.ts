/** Matches texts with typed words: in any order, with beginnings of words preferred. Rates the match and locates it. */

/** A part of a text, in characters. */
export interface TextSpan {
  readonly start: number;
  readonly length: number;
}

export interface Match {
  /** Higher is better. */
  readonly score: number;
  readonly spans: readonly TextSpan[];
}

/** A typed text, prepared to be matched with many texts. */
export interface Query {
  readonly words: readonly string[];
}

export function queryOf(text: string): Query {
  return { words: text.toLowerCase().split(/\s+/).filter(Boolean) };
}

const BEGINS_TEXT = 100;
const BEGINS_WORD = 60;
const INSIDE = 30;
const SCATTERED = 5;

/** Score of a match without its location; -1 if a word is missing. `lower` is the text in lower case. `loose` also accepts letters
 * in order with gaps (`fmg` finds Fetch the mug). */
export function scoreOf(query: Query, text: string, lower: string, loose = false): number {
  let score = 0;
  let letters = 0;
  for (const word of query.words) {
    const at = bestPlace(word, text, lower);
    letters += word.length;
    if (at >= 0) score += at === 0 ? BEGINS_TEXT : beginsWord(text, at) ? BEGINS_WORD : INSIDE;
    else if (loose && isScattered(word, lower)) score += SCATTERED;
    else return -1;
  }
  const exact = letters === text.length ? EXACT : 0;
  return score + exact + Math.max(0, LENGTH_MAX - text.length) / 10;
}

const EXACT = 40;
const LENGTH_MAX = 200;

/** Score and location of a match; null if a word is missing. */
export function match(query: Query, text: string, loose = false): Match | null {
  const lower = text.toLowerCase();
  const score = scoreOf(query, text, lower, loose);
  if (score < 0) return null;
  const spans = query.words.flatMap((word): TextSpan[] => {
    const start = bestPlace(word, text, lower);
    return start < 0 ? scattered(word, lower) : [{ start, length: word.length }];
  });
  return { score, spans: joined(spans) };
}

/** Position of the word in the text: at the beginning of a word if possible. */
function bestPlace(word: string, text: string, lower: string): number {
  const first = lower.indexOf(word);
  if (first <= 0) return first;
  for (let at = first; at >= 0; at = lower.indexOf(word, at + 1)) {
    if (beginsWord(text, at)) return at;
  }
  return first;
}

/** True after a character that is neither letter nor digit, and at a change from lower to upper case: `grab|Object`. */
function beginsWord(text: string, at: number): boolean {
  const [before, here] = [text.charAt(at - 1), text.charAt(at)];
  if (!/[\p{L}\p{N}]/u.test(before)) return true;
  return /\p{Ll}/u.test(before) && /\p{Lu}/u.test(here);
}

function isScattered(word: string, lower: string): boolean {
  let at = -1;
  for (const letter of word) {
    at = lower.indexOf(letter, at + 1);
    if (at < 0) return false;
  }
  return true;
}

function scattered(word: string, lower: string): TextSpan[] {
  let at = -1;
  return [...word].map((letter) => {
    at = lower.indexOf(letter, at + 1);
    return { start: at, length: letter.length };
  });
}

/** Spans in order, without overlaps. */
function joined(spans: readonly TextSpan[]): readonly TextSpan[] {
  const found: TextSpan[] = [];
  for (const span of [...spans].sort((one, other) => one.start - other.start)) {
    const last = found.at(-1);
    const end = last ? last.start + last.length : -1;
    if (!last || span.start > end) found.push(span);
    else {
      const length = Math.max(end, span.start + span.length) - last.start;
      found[found.length - 1] = { start: last.start, length };
    }
  }
  return found;
}
