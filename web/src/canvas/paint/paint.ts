/** Paints a list of marks without any decision about content. Marks of one style are painted together, for speed. */

import type { BoxMark, DotMark, DrawList, Layer, LineMark } from "../scene/list.ts";
import type { Colours } from "./colours.ts";
import { paintDot } from "./dots.ts";
import { paintIcon } from "./icons.ts";
import { inkOf, type PaintContext } from "./ink.ts";
import { paintLine } from "./line.ts";
import { paintTexts } from "./texts.ts";

/** Paints on top of the current picture; CSS pixels are the unit of the context. */
export function paint(context: PaintContext, list: DrawList, colours: Colours): void {
  for (const layer of list.layers) paintShapes(context, layer, colours);
  for (const layer of list.layers) {
    paintTexts(context, layer.texts, colours);
    for (const icon of layer.icons) paintIcon(context, icon, inkOf(colours, icon.ink));
  }
  context.globalAlpha = 1;
}

function paintShapes(context: PaintContext, layer: Layer, colours: Colours): void {
  paintLines(context, layer.under, colours);
  paintSpecks(context, layer.specks, colours);
  paintBoxes(context, layer.boxes, colours);
  paintLines(context, layer.lines, colours);
  paintDots(context, layer.dots, colours);
}

function paintSpecks(context: PaintContext, specks: readonly BoxMark[], colours: Colours): void {
  context.globalAlpha = 1;
  let ink: string | null = null;
  let alpha = 1;
  for (const speck of specks) {
    if (speck.alpha !== alpha) {
      alpha = speck.alpha;
      context.globalAlpha = alpha;
    }
    if (speck.fill !== ink) {
      ink = speck.fill;
      context.fillStyle = inkOf(colours, ink ?? "outline");
    }
    context.fillRect(
      speck.x,
      speck.y,
      Math.max(1, speck.width - 0.5),
      Math.max(1, speck.height - 0.5),
    );
  }
}

function paintBoxes(context: PaintContext, boxes: readonly BoxMark[], colours: Colours): void {
  for (const box of boxes) {
    context.globalAlpha = box.alpha;
    if (box.radius < 1.5 || (box.width < 14 && box.height < 14)) paintSquare(context, box, colours);
    else paintRounded(context, box, colours);
  }
}

/** Small box. An outline drawn as a larger box below it is by far the fastest. */
function paintSquare(context: PaintContext, box: BoxMark, colours: Colours): void {
  const { x, y, width, height, line } = box;
  if (box.fill === null || box.dash) {
    if (box.fill !== null) {
      context.fillStyle = inkOf(colours, box.fill);
      context.fillRect(x, y, width, height);
    }
    strokeStyle(context, box, colours);
    context.strokeRect(x, y, width, height);
    if (box.dash) context.setLineDash(SOLID);
    return;
  }
  if (box.stroke !== null) {
    context.fillStyle = inkOf(colours, box.stroke);
    context.fillRect(x, y, width, height);
  }
  context.fillStyle = inkOf(colours, box.fill);
  context.fillRect(
    x + line,
    y + line,
    Math.max(0, width - 2 * line),
    Math.max(0, height - 2 * line),
  );
}

const SOLID: number[] = [];
const DASHED = [5, 4];

function paintRounded(context: PaintContext, box: BoxMark, colours: Colours): void {
  context.beginPath();
  context.roundRect(box.x, box.y, box.width, box.height, box.radius);
  if (box.fill !== null) {
    context.fillStyle = inkOf(colours, box.fill);
    context.fill();
  }
  if (box.stroke === null) return;
  strokeStyle(context, box, colours);
  context.stroke();
  if (box.dash) context.setLineDash(SOLID);
}

function strokeStyle(context: PaintContext, box: BoxMark, colours: Colours): void {
  context.strokeStyle = inkOf(colours, box.stroke ?? "outline");
  context.lineWidth = box.line;
  if (box.dash) context.setLineDash(DASHED);
}

/** Joins lines of one style into one path. */
function paintLines(context: PaintContext, lines: readonly LineMark[], colours: Colours): void {
  if (lines.length === 0) return;
  context.lineJoin = "round";
  let last: LineMark | null = null;
  let open = false;
  for (const line of lines) {
    if (last === null || !alike(last, line)) {
      if (open) context.stroke();
      context.strokeStyle = inkOf(colours, line.ink);
      context.lineWidth = line.width;
      context.globalAlpha = line.alpha;
      context.setLineDash(line.dash ? DASHED : SOLID);
      context.beginPath();
      open = true;
    }
    paintLine(context, line);
    last = line;
  }
  if (open) context.stroke();
  context.setLineDash(SOLID);
}

function alike(one: LineMark, other: LineMark): boolean {
  return (
    one.ink === other.ink &&
    one.width === other.width &&
    one.alpha === other.alpha &&
    one.dash === other.dash
  );
}

function paintDots(context: PaintContext, dots: readonly DotMark[], colours: Colours): void {
  for (const dot of dots) {
    context.globalAlpha = dot.alpha;
    paintDot(
      context,
      dot,
      dot.fill && inkOf(colours, dot.fill),
      dot.stroke && inkOf(colours, dot.stroke),
    );
  }
}
