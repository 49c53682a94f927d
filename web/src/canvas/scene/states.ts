/** Box of a state with all marks on its border: kind, selection, differences, and the run. */

import { breakpointMarks } from "./breakpoints.ts";
import type { SceneBuilder, SceneNode } from "./builder.ts";
import { TEXT } from "./detail.ts";
import type { DifferenceKind } from "./input.ts";
import type { SignPlace } from "./labels.ts";
import type { BoxMark, TextMark } from "./list.ts";
import { groundInk, radiusOf, ring } from "./ring.ts";
import { runMarks, visitMarks } from "./runs.ts";

/** Margin around the view in which a box is drawn exactly, in CSS pixels. */
const BEYOND = 40;

/** `isOpen` is a state with visible content. */
export function stateMarks(builder: SceneBuilder, node: SceneNode, isOpen: boolean): void {
  const layer = builder.layer(node.depth);
  const { input } = builder;
  const { path, key } = node.at;
  layer.boxes.push(ground(builder, node, isOpen));
  const run = input.runs.get(path);
  if (run) runMarks(builder, node, run, isOpen);
  else visitMarks(builder, node);
  breakpointMarks(builder, node);
  const difference = input.differences.get(key);
  if (difference) layer.boxes.push(ring(node, DIFFERENCE_INK[difference], 2, 2, key));
  if (input.hits.has(key)) layer.boxes.push(ring(node, "hit", 2, 4, key));
  const onlooker = builder.onlookers.get(path);
  const person = onlooker === undefined ? undefined : input.people[onlooker];
  if (person) onlookerMarks(builder, node, person.name, `person${person.colour % PEOPLE}`);
  if (input.hovered?.kind === "state" && input.hovered.path === path) {
    layer.boxes.push(ring(node, "hover", 1, 0, key));
    const error = input.errors.get(path);
    if (error) builder.pointed = { x: node.x, y: node.y + node.height, text: error };
  }
  if (!builder.isSelected(key)) return;
  layer.boxes.push(ring(node, "selection", 2, 1, key));
  if (node.extent >= LEAST_FOR_HANDLES) handleMarks(builder, node, key);
}

/** Smallest state with resize handles, in CSS pixels. */
const LEAST_FOR_HANDLES = 40;

/** Resize handles of a selected state. The root grows only to the right and downwards. */
function handleMarks(builder: SceneBuilder, node: SceneNode, key: string): void {
  const layer = builder.layer(node.depth + 1);
  const { x, y, width, height } = node;
  const corners: readonly (readonly [number, number])[] = [
    [x + width, y + height],
    ...(node.outer
      ? ([
          [x, y],
          [x + width, y],
          [x, y + height],
        ] as const)
      : []),
  ];
  for (const [left, top] of corners) {
    layer.dots.push({
      what: `${key} handle`,
      shape: "handle",
      x: left,
      y: top,
      size: 8,
      toX: 0,
      toY: 0,
      fill: "handle",
      stroke: "selection",
      alpha: 1,
    });
  }
}

/** Number of colours of people. */
const PEOPLE = 6;

const DIFFERENCE_INK: Readonly<Record<DifferenceKind, string>> = {
  added: "added",
  removed: "removed",
  changed: "changed",
};

function ground(builder: SceneBuilder, node: SceneNode, isOpen: boolean): BoxMark {
  const { at } = node;
  const heat = isOpen ? undefined : builder.input.heat?.get(at.path);
  const isLibrary = at.state.kind === "library";
  return {
    ...clipped(builder, node),
    what: at.key,
    radius: radiusOf(node),
    fill: heat === undefined ? groundInk(node) : `heat${heat}`,
    stroke: isLibrary ? "library-outline" : "outline",
    line: node.extent > 240 ? 1.5 : 1,
    dash: at.state.library?.missing != null,
    alpha: 1,
  };
}

/** Part of a box near the view. Canvases are imprecise with very large numbers. */
function clipped(builder: SceneBuilder, node: SceneNode) {
  const left = Math.max(node.x, -BEYOND);
  const top = Math.max(node.y, -BEYOND);
  const right = Math.min(node.x + node.width, builder.width + BEYOND);
  const bottom = Math.min(node.y + node.height, builder.height + BEYOND);
  return { x: left, y: top, width: right - left, height: bottom - top };
}

/** Frame in the colour of a user who has selected the state. The name is above or below it, where it covers no name of a state. */
function onlookerMarks(builder: SceneBuilder, node: SceneNode, name: string, ink: string): void {
  const layer = builder.layer(node.depth);
  layer.boxes.push(ring(node, ink, 1.5, 3, node.at.key));
  const [left, right] = [node.x + 4, node.x + node.width - 4];
  const [above, below] = [node.y - 10, node.y + node.height + 10];
  const at = (x: number, y: number, align: TextMark["align"]): SignPlace => ({
    icons: [],
    texts: [
      {
        what: `${node.at.key} onlooker`,
        x,
        y,
        text: name,
        size: TEXT.small,
        bold: true,
        ink: "on-person",
        align,
        alpha: 1,
        plate: ink,
        width: builder.input.measure(name, TEXT.small, true),
      },
    ],
  });
  const places = [
    at(left, above, "left"),
    at(right, above, "right"),
    at(left, below, "left"),
    at(right, below, "right"),
  ];
  builder.signs.push({ layer, places });
}
