/** Which of the states around one are named above the canvas: as many as there is room for. */

/** About what a letter, and all else of a crumb, takes in CSS pixels. */
const LETTER_PX = 7.5;
const CRUMB_PX = 25;
/** Longer names are cut. */
const LETTERS_MAX = 24;

/** Those that give way, as one `…`: a part of the list. The root and the innermost stay. */
interface Crumbs {
  readonly from: number;
  readonly to: number;
}

/** Names of states from the root inwards. */
export function crumbsIn(names: readonly string[], room_px: number): Crumbs {
  let left = room_px;
  for (const name of names) left -= widthOf(name);
  let to = 1;
  while (left < 0 && to < names.length - 1) {
    if (to === 1) left -= widthOf("…");
    left += widthOf(names[to] ?? "");
    to += 1;
  }
  return { from: 1, to };
}

function widthOf(name: string): number {
  return Math.min(name.length, LETTERS_MAX) * LETTER_PX + CRUMB_PX;
}
