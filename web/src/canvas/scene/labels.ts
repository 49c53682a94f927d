/** Names of ports and labels of connections where nothing else is written: the first that asks for a place has it. */

import type { SceneBuilder } from "./builder.ts";
import type { TextMark } from "./list.ts";

/** How coarse the board is that remembers what is written where, in CSS pixels. */
const CELL = 64;
const HEIGHT = 14;

interface LabelSpan {
  readonly left: number;
  readonly right: number;
  readonly y: number;
}

export function labelMarks(builder: SceneBuilder): void {
  if (builder.labels.length + builder.portNames.length === 0) return;
  const board = new Map<number, LabelSpan[]>();
  for (const { texts } of builder.layers) for (const text of texts) write(board, textArea(text));
  const layer = builder.top();
  for (const label of [...builder.portNames, ...builder.labels]) {
    if (!builder.sees(label.x, label.y, 0, 0, 100)) continue;
    const area = textArea(label);
    if (!isFree(board, area)) continue;
    write(board, area);
    layer.texts.push(label);
  }
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
