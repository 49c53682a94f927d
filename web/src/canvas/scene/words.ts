/** Texts that fit: cut with an ellipsis, or wrapped over several lines. */

import type { Measure } from "./input.ts";

/** Number at the end of a name, which distinguishes `Waypoint 12` from `Waypoint 13`. */
const NUMBER = /\s?\d{1,4}$/;

/** Characters of the longest number, with the space before it. */
const NUMBER_MAX = 5;
/** Maximum number of characters of a text on the canvas. */
const LETTERS_MAX = 1_000;

/** Beginning of a text, cut where it is wider than any screen. */
function readable(text: string): string {
  return text.length > LETTERS_MAX ? `${text.slice(0, LETTERS_MAX)}…` : text;
}

/** Text, cut with an ellipsis if necessary. The number at its end is kept if there is room for both. Empty if not even two
 * letters fit. */
export function cut(whole: string, width: number, size: number, bold: boolean, measure: Measure) {
  const text = readable(whole);
  if (measure(text, size, bold) <= width) return text;
  const number = NUMBER.exec(whole.slice(-NUMBER_MAX))?.[0] ?? "";
  const fits = (letters: number, end: string) =>
    measure(`${text.slice(0, letters)}…${end}`, size, bold) <= width;
  const end = fits(2, number) ? number : "";
  let [low, high] = [0, text.length - 1 - end.length];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (fits(middle, end)) low = middle;
    else high = middle - 1;
  }
  return low < 2 ? "" : `${text.slice(0, low).trimEnd()}…${end}`;
}

/** Text in at most `lines` lines, broken between words; the rest is cut. */
export function wrapped(
  whole: string,
  width: number,
  lines: number,
  size: number,
  measure: Measure,
): readonly string[] {
  const text = readable(whole);
  if (lines <= 1 || measure(text, size, false) <= width) {
    const only = cut(text, width, size, false, measure);
    return only === "" ? [] : [only];
  }
  return inLines(text, { width, lines, size, measure }, () => 0);
}

/** Like `wrapped`, for a name. Words that are too long for a line are hyphenated if all characters fit then. */
export function wrappedName(
  name: string,
  width: number,
  lines: number,
  size: number,
  measure: Measure,
): readonly string[] {
  const plain = wrapped(name, width, lines, size, measure);
  if (lines <= 1 || !isCut(plain)) return plain;
  const room = { width, lines, size, measure };
  const broken = inLines(readable(name), room, (word) => lettersBefore(word, room));
  return isCut(broken) ? plain : broken;
}

interface LineRoom {
  readonly width: number;
  readonly lines: number;
  readonly size: number;
  readonly measure: Measure;
}

function isCut(lines: readonly string[]): boolean {
  return lines.some((line) => line.includes("…"));
}

/** `hyphenAt` returns the number of letters of a word before a hyphen at the end of the line; 0 for no hyphen. */
function inLines(
  text: string,
  { width, lines, size, measure }: LineRoom,
  hyphenAt: (word: string) => number,
): readonly string[] {
  const found: string[] = [];
  const rest = text.split(/(?<=[\s_])/);
  let line = "";
  for (let word = rest.shift(); word !== undefined; word = rest.shift()) {
    const isLast = found.length === lines - 1;
    if (line !== "" && measure((line + word).trimEnd(), size, false) > width) {
      if (isLast) {
        line += word + rest.join("");
        break;
      }
      found.push(cut(line.trimEnd(), width, size, false, measure));
      line = "";
      rest.unshift(word);
      continue;
    }
    const letters = line === "" && !isLast ? hyphenAt(word) : 0;
    if (letters > 0) {
      found.push(`${word.slice(0, letters)}-`);
      rest.unshift(word.slice(letters));
    } else line += word;
  }
  found.push(cut(line.trimEnd(), width, size, false, measure));
  return found.filter((each) => each !== "");
}

/** Smallest numbers of letters before and after a hyphen. */
const LEAST_BEFORE = 3;
const LEAST_BEHIND = 2;

/** Number of letters that fit before a hyphen; 0 if the word fits, or if too few letters do. */
function lettersBefore(word: string, { width, size, measure }: LineRoom): number {
  const whole = word.trimEnd();
  if (measure(whole, size, false) <= width) return 0;
  let letters = whole.length - LEAST_BEHIND;
  while (letters >= LEAST_BEFORE && measure(`${whole.slice(0, letters)}-`, size, false) > width) {
    letters -= 1;
  }
  return letters >= LEAST_BEFORE ? letters : 0;
}
