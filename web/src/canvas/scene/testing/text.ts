/** A picture as text, a mark a line: what tests read. */

import type { BoxMark, DotMark, DrawList, IconMark, Layer, LineMark, TextMark } from "../list.ts";

export function listText({ layers, wanted }: DrawList): string {
  const lines = layers.flatMap((layer, depth) =>
    layerText(layer).map((text) => `${depth} ${text}`),
  );
  return [...lines, ...wanted.map((path) => `wanted ${path}`)].join("\n");
}

function layerText(layer: Layer): readonly string[] {
  return [
    ...layer.under.map((mark) => `under ${lineText(mark)}`),
    ...layer.specks.map((mark) => `speck ${boxText(mark)}`),
    ...layer.boxes.map((mark) => `box ${boxText(mark)}`),
    ...layer.lines.map((mark) => `line ${lineText(mark)}`),
    ...layer.dots.map(dotText),
    ...layer.icons.map(iconText),
    ...layer.texts.map(textText),
  ];
}

function boxText({ what, x, y, width, height, fill, stroke, dash, alpha }: BoxMark): string {
  const at = [x, y, width, height].map(Math.round).join(" ");
  return words(what, at, fill, stroke && `|${stroke}|`, dash && "dashed", faint(alpha));
}

function lineText({ what, points, ink, arrow, dash, alpha }: LineMark): string {
  const way = points.length > 12 ? `${points.length / 2} points` : points.map(Math.round).join(" ");
  return words(what, way, ink, arrow > 0 && "arrow", dash && "dashed", faint(alpha));
}

function dotText({ what, shape, x, y, fill, stroke, alpha }: DotMark): string {
  return words("dot", what, shape, at(x, y), fill, stroke && `|${stroke}|`, faint(alpha));
}

function iconText({ what, icon, x, y, ink, alpha }: IconMark): string {
  return words("icon", what, icon, at(x, y), ink, faint(alpha));
}

function textText({ what, text, x, y, size, ink, alpha }: TextMark): string {
  return words("text", what, JSON.stringify(text), at(x, y), `${size}px`, ink, faint(alpha));
}

function at(x: number, y: number): string {
  return `${Math.round(x)} ${Math.round(y)}`;
}

function faint(alpha: number): string | false {
  return alpha < 1 && `${Math.round(alpha * 100)}%`;
}

function words(...all: readonly (string | null | false)[]): string {
  return all.filter((word) => word).join(" ");
}
