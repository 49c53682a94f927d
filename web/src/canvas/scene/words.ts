/** Text that fits: cut with an ellipsis, or over several lines. */

import type { Measure } from "./input.ts";

/** The number at the end of a name: what tells `Waypoint 12` from `Waypoint 13`. */
const NUMBER = /\s?\d{1,4}$/;

/** Letters of the longest number with the space before it. */
const NUMBER_MAX = 5;
/** Letters of a text that a canvas shows at most. */
const LETTERS_MAX = 1_000;

/** The beginning of a text that is longer than any screen is wide. */
function readable(text: string): string {
  return text.length > LETTERS_MAX ? `${text.slice(0, LETTERS_MAX)}…` : text;
}

/** The text, or as much of it as fits with an ellipsis, before the number at its end if there is room for both; nothing if not even
 * two letters fit. */
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

/** The text in at most so many lines, broken between words; what is left over is cut. */
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
  const found: string[] = [];
  let line = "";
  const words = text.split(/(?<=[\s_])/);
  for (const [index, word] of words.entries()) {
    if (line === "" || measure((line + word).trimEnd(), size, false) <= width) {
      line += word;
      continue;
    }
    if (found.length === lines - 1) {
      line += words.slice(index).join("");
      break;
    }
    found.push(cut(line.trimEnd(), width, size, false, measure));
    line = word;
  }
  found.push(cut(line.trimEnd(), width, size, false, measure));
  return found.filter((each) => each !== "");
}
