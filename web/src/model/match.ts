/** How well a text fits what somebody types, and where: words in any order, beginnings of words first. */

/** A part of a text: from a letter on, so many. */
export interface Span {
  readonly start: number;
  readonly length: number;
}

export interface Match {
  /** The higher the better. */
  readonly score: number;
  readonly spans: readonly Span[];
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

/** Null if not every word is there. `loose`: letters may also stand apart, in order (`fmg` finds Fetch the mug). */
export function match(query: Query, text: string, loose = false): Match | null {
  const lower = text.toLowerCase();
  let score = 0;
  const spans: Span[] = [];
  for (const word of query.words) {
    const found = placeOf(word, lower, text) ?? (loose ? scattered(word, lower) : null);
    if (!found) return null;
    score += found.score;
    spans.push(...found.spans);
  }
  const exact = lower.length === spans.reduce((sum, { length }) => sum + length, 0);
  return { score: score + (exact ? 40 : 0) - Math.min(20, text.length / 10), spans: joined(spans) };
}

function placeOf(word: string, lower: string, text: string): Match | null {
  const first = lower.indexOf(word);
  if (first < 0) return null;
  if (first === 0) return { score: BEGINS_TEXT, spans: [{ start: 0, length: word.length }] };
  for (let at = first; at >= 0; at = lower.indexOf(word, at + 1)) {
    if (beginsWord(text, at)) {
      return { score: BEGINS_WORD, spans: [{ start: at, length: word.length }] };
    }
  }
  return { score: INSIDE, spans: [{ start: first, length: word.length }] };
}

/** After something that is no letter, or where small letters end: `grab|Object`. */
function beginsWord(text: string, at: number): boolean {
  const [before, here] = [text.charAt(at - 1), text.charAt(at)];
  if (!/[\p{L}\p{N}]/u.test(before)) return true;
  return /\p{Ll}/u.test(before) && /\p{Lu}/u.test(here);
}

function scattered(word: string, lower: string): Match | null {
  const spans: Span[] = [];
  let at = -1;
  for (const letter of word) {
    at = lower.indexOf(letter, at + 1);
    if (at < 0) return null;
    spans.push({ start: at, length: 1 });
  }
  const wide = (spans.at(-1)?.start ?? 0) - (spans[0]?.start ?? 0);
  return { score: SCATTERED - Math.min(4, wide / 10), spans };
}

/** In order, without overlaps. */
function joined(spans: readonly Span[]): readonly Span[] {
  const found: Span[] = [];
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
