/** Texts, and the plates behind them. */

import type { TextMark } from "../scene/list.ts";
import type { Colours } from "./colours.ts";
import { inkOf, type PaintContext } from "./ink.ts";

const FAMILY = '"Inter Variable", system-ui, sans-serif';

/** Characters of a text that are measured and painted. More would not be visible. */
export const LETTERS_MAX = 2_000;

/** Font of a text on the canvas. */
export function fontOf(size: number, bold: boolean): string {
  return `${bold ? 600 : 450} ${size}px ${FAMILY}`;
}

export function paintTexts(
  context: PaintContext,
  texts: readonly TextMark[],
  colours: Colours,
): void {
  context.textBaseline = "middle";
  let [font, align, ink] = ["", "", ""];
  for (const text of texts) {
    if (text.text === "" && text.plate === null) continue;
    const wanted = fontOf(text.size, text.bold);
    if (wanted !== font) {
      context.font = wanted;
      font = wanted;
    }
    if (text.align !== align) {
      context.textAlign = text.align;
      align = text.align;
    }
    // Plates are opaque: a transparent one would half erase the marks below it.
    context.globalAlpha = 1;
    if (text.plate !== null) paintPlate(context, text, inkOf(colours, text.plate));
    context.globalAlpha = text.alpha;
    if (text.ink !== ink || text.plate !== null) {
      context.fillStyle = inkOf(colours, text.ink);
      ink = text.ink;
    }
    context.fillText(text.text.slice(0, LETTERS_MAX), text.x, text.y + 0.5);
  }
}

const AROUND = 4;

function paintPlate(context: PaintContext, text: TextMark, colour: string): void {
  const inner =
    text.width ||
    (text.text === "" ? 0 : context.measureText(text.text.slice(0, LETTERS_MAX)).width);
  const width = inner + 2 * AROUND;
  const height = text.size + 5;
  const lead = text.lead ?? 0;
  context.fillStyle = colour;
  context.beginPath();
  context.roundRect(leftOf(text, width) - lead, text.y - height / 2, width + lead, height, 4);
  context.fill();
}

function leftOf({ align, x }: TextMark, width: number): number {
  if (align === "left") return x - AROUND;
  return align === "right" ? x + AROUND - width : x - width / 2;
}
