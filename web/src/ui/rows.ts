/** Height of rows in virtual lists, equal to `--row` in `tokens.css`. */

const ROW_PX = 24;
const FINGER_ROW_PX = 32;

export function rowHeight(): number {
  return window.matchMedia("(pointer: coarse)").matches ? FINGER_ROW_PX : ROW_PX;
}
