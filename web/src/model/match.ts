/** How well a text fits what somebody types, and where: words in any order, beginnings of words first. */

/** A part of a text: from a letter on, so many. */
export interface TextSpan {
  readonly start: number;
  readonly length: number;
}

export interface Match {
  /** The higher the better. */
  readonly score: number;
  readonly spans: readonly TextSpan[];
}

/** What somebody types, ready to be looked for in many texts. */
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

/** How well it fits, without where; -1 if not every word is there. `lower` is the text in small letters. `loose`: letters may
 * also stand apart, in order (`fmg` finds Fetch the mug). */
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

/** The same with where; null if not every word is there. */
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

/** Where the word stands: where a word begins if it does so anywhere. */
function bestPlace(word: string, text: string, lower: string): number {
  const first = lower.indexOf(word);
  if (first <= 0) return first;
  for (let at = first; at >= 0; at = lower.indexOf(word, at + 1)) {
    if (beginsWord(text, at)) return at;
  }
  return first;
}

/** After something that is no letter, or where small letters end: `grab|Object`. */
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

/** In order, without overlaps. */
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
