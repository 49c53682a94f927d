/** Widths of texts, measured once and then cached. */

import type { Measure } from "../scene/input.ts";
import type { PaintContext } from "./ink.ts";
import { fontOf, LETTERS_MAX } from "./texts.ts";

/** Capacity of the cache per font. A full cache is cleared. */
const MOST = 20_000;

/** Measures with the font of this context. Create it anew after fonts have loaded. */
export function measureWith(context: PaintContext): Measure {
  const known = new Map<string, Map<string, number>>();
  return (whole, size, bold) => {
    const text = whole.slice(0, LETTERS_MAX);
    const font = `${size}${bold}`;
    let widths = known.get(font);
    if (!widths || widths.size > MOST) {
      widths = new Map();
      known.set(font, widths);
    }
    let width = widths.get(text);
    if (width === undefined) {
      context.font = fontOf(size, bold);
      width = context.measureText(text).width;
      widths.set(text, width);
    }
    return width;
  };
}
