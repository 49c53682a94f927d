/** Names of ports and labels of connections, placed where there is no other text. Earlier labels take precedence. */

import type { SceneBuilder } from "./builder.ts";
import type { IconMark, Layer, TextMark } from "./list.ts";

/** Cell size of the board that records occupied areas, in CSS pixels. */
const CELL = 64;
const HEIGHT = 14;
/** Distance below which equal labels in one row, on lines to one goal, are drawn only once, in CSS pixels. */
const REPEATED = 200;

/** Text that is drawn only where there is no other text. */
export interface Label extends TextMark {
  /** Key of the end of the labelled transition. */
  readonly goal?: string;
}

interface WrittenLabel extends LabelSpan {
  readonly label: Label;
}

/** Marks that belong together, at one of their possible places. */
export interface SignPlace {
  readonly texts: readonly TextMark[];
  readonly icons: readonly IconMark[];
}

/** Marks with several possible places, which avoid names. */
export interface SignGroup {
  readonly layer: Layer;
  /** Possible places, the best first. */
  readonly places: readonly SignPlace[];
}

interface LabelSpan {
  readonly left: number;
  readonly right: number;
  readonly y: number;
}

export function labelMarks(builder: SceneBuilder): void {
  const labels: readonly Label[] = [
    ...builder.portNames,
    ...builder.labels,
    ...builder.smallPortNames,
  ];
  if (labels.length + builder.signs.length === 0) return;
  const board = new Map<number, LabelSpan[]>();
  for (const { texts } of builder.layers) for (const text of texts) write(board, textArea(text));
  for (const signs of builder.signs) putSigns(board, signs);
  if (labels.length === 0) return;
  const layer = builder.top();
  const written: WrittenLabel[] = [];
  for (const label of labels) {
    if (!builder.sees(label.x, label.y, 0, 0, 100)) continue;
    const area = textArea(label);
    if (!isFree(board, area) || isRepeated(written, label, area)) continue;
    write(board, area);
    written.push({ ...area, label });
    layer.texts.push(label);
  }
}

/** Puts signs at the first place without text; without such a place they are left out. */
function putSigns(board: Map<number, LabelSpan[]>, { layer, places }: SignGroup): void {
  for (const { texts, icons } of places) {
    const areas = [...texts.map(textArea), ...icons.map(iconArea)];
    if (!areas.every((area) => isFree(board, area))) continue;
    for (const area of areas) write(board, area);
    layer.texts.push(...texts);
    layer.icons.push(...icons);
    return;
  }
}

function iconArea({ x, y, size }: IconMark): LabelSpan {
  return { left: x - size / 2, right: x + size / 2, y };
}

/** True if another line to this goal has an equal label in this row. */
function isRepeated(
  written: readonly WrittenLabel[],
  { text, goal }: Label,
  { left, y }: LabelSpan,
): boolean {
  if (goal === undefined) return false;
  return written.some(
    (other) =>
      other.label.goal === goal &&
      other.label.text === text &&
      Math.abs(other.y - y) < HEIGHT &&
      Math.abs(other.left - left) < REPEATED,
  );
}

function textArea({ x, y, align, width, text, size }: TextMark): LabelSpan {
  const wide = (width || text.length * size * 0.58) + 6;
  const left = align === "left" ? x - 3 : align === "right" ? x + 3 - wide : x - wide / 2;
  return { left, right: left + wide, y };
}

function cellsOf({ left, right, y }: LabelSpan): readonly number[] {
  const cells: number[] = [];
  for (let column = Math.floor(left / CELL); column <= Math.floor(right / CELL); column++) {
    for (let row = Math.floor((y - HEIGHT) / CELL); row <= Math.floor((y + HEIGHT) / CELL); row++) {
      cells.push(column * 4096 + row);
    }
  }
  return cells;
}

function write(board: Map<number, LabelSpan[]>, area: LabelSpan): void {
  for (const cell of cellsOf(area)) {
    const there = board.get(cell);
    if (there) there.push(area);
    else board.set(cell, [area]);
  }
}

function isFree(board: Map<number, LabelSpan[]>, area: LabelSpan): boolean {
  return cellsOf(area).every((cell) =>
    (board.get(cell) ?? []).every(
      (other) =>
        Math.abs(other.y - area.y) >= HEIGHT ||
        other.left >= area.right ||
        other.right <= area.left,
    ),
  );
}
