/** Value at the hovered port, cut to a few lines. */

import type { SceneBuilder } from "./builder.ts";
import { TEXT } from "./detail.ts";
import { wrapped } from "./words.ts";

const WIDTH = 320;
const LINES = 8;
const PITCH = 17;

export function pointedMarks(builder: SceneBuilder): void {
  const { pointed } = builder;
  if (!pointed) return;
  const { measure } = builder.input;
  const lines = wrapped(pointed.text, WIDTH, LINES, TEXT.usual, measure);
  const widths = lines.map((text) => measure(text, TEXT.usual, false));
  const widest = Math.max(0, ...widths);
  const x = Math.max(8, Math.min(pointed.x + 12, builder.width - widest - 12));
  const top = Math.max(12, Math.min(pointed.y + 22, builder.height - lines.length * PITCH - 8));
  const layer = builder.top();
  for (const [index, text] of lines.entries()) {
    layer.texts.push({
      what: "value",
      x,
      y: top + index * PITCH,
      text,
      size: TEXT.usual,
      bold: false,
      ink: "text",
      align: "left",
      alpha: 1,
      plate: "good",
      width: widest,
    });
  }
}
