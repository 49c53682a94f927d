/** The box of a state with all that its border tells: its kind, what is selected, what differs, what runs. */

import { breakpointMarks } from "./breakpoints.ts";
import type { Drawing, Spot } from "./drawing.ts";
import type { Difference } from "./input.ts";
import type { BoxMark, Layer } from "./list.ts";
import { groundInk, radiusOf, ring } from "./ring.ts";
import { runMarks, visitMarks } from "./runs.ts";

/** How far beyond the view a box is still drawn exactly. */
const BEYOND = 40;

/** `isOpen` is a state whose content shows. */
export function stateMarks(drawing: Drawing, spot: Spot, isOpen: boolean): void {
  const layer = drawing.layer(spot.depth);
  const { input } = drawing;
  const { path, key } = spot.at;
  layer.boxes.push(ground(drawing, spot, isOpen));
  const run = input.runs.get(path);
  if (run) runMarks(drawing, spot, run, isOpen);
  else visitMarks(drawing, spot);
  breakpointMarks(drawing, spot);
  const difference = input.differences.get(key);
  if (difference) layer.boxes.push(ring(spot, DIFFERENCE_INK[difference], 2, 2, key));
  if (input.hits.has(key)) layer.boxes.push(ring(spot, "hit", 2, 4, key));
  const onlooker = drawing.onlookers.get(path);
  const person = onlooker === undefined ? undefined : input.people[onlooker];
  if (person) onlookerMarks(layer, spot, person.name, `person${person.colour % PEOPLE}`);
  if (input.hovered?.kind === "state" && input.hovered.path === path) {
    layer.boxes.push(ring(spot, "hover", 1, 0, key));
  }
  if (!drawing.isSelected(key)) return;
  layer.boxes.push(ring(spot, "selection", 2, 1, key));
  if (spot.extent >= LEAST_FOR_HANDLES) handleMarks(drawing, spot, key);
}

/** Smaller states are not resized. */
const LEAST_FOR_HANDLES = 40;

/** Where a selected state is taken to be resized: the root grows to the right and downwards only. */
function handleMarks(drawing: Drawing, spot: Spot, key: string): void {
  const layer = drawing.layer(spot.depth + 1);
  const { x, y, width, height } = spot;
  const corners: readonly (readonly [number, number])[] = [
    [x + width, y + height],
    ...(spot.outer
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

/** So many colours of people there are. */
export const PEOPLE = 6;

export const DIFFERENCE_INK: Readonly<Record<Difference, string>> = {
  added: "added",
  removed: "removed",
  changed: "changed",
};

function ground(drawing: Drawing, spot: Spot, isOpen: boolean): BoxMark {
  const { at } = spot;
  const heat = isOpen ? undefined : drawing.input.heat?.get(at.path);
  const isLibrary = at.state.kind === "library";
  return {
    ...clipped(drawing, spot),
    what: at.key,
    radius: radiusOf(spot),
    fill: heat === undefined ? groundInk(spot) : `heat${heat}`,
    stroke: isLibrary ? "library-outline" : "outline",
    line: spot.extent > 240 ? 1.5 : 1,
    dash: at.state.library?.missing != null,
    alpha: 1,
  };
}

/** The part of a box near the view: canvases are not good at huge numbers. */
function clipped(drawing: Drawing, spot: Spot) {
  const left = Math.max(spot.x, -BEYOND);
  const top = Math.max(spot.y, -BEYOND);
  const right = Math.min(spot.x + spot.width, drawing.width + BEYOND);
  const bottom = Math.min(spot.y + spot.height, drawing.height + BEYOND);
  return { x: left, y: top, width: right - left, height: bottom - top };
}

function onlookerMarks(layer: Layer, spot: Spot, name: string, ink: string): void {
  layer.boxes.push(ring(spot, ink, 1.5, 3, spot.at.key));
  layer.texts.push({
    what: `${spot.at.key} onlooker`,
    x: spot.x + 4,
    y: spot.y - 10,
    text: name,
    size: 11,
    bold: true,
    ink: "on-person",
    align: "left",
    alpha: 1,
    plate: ink,
    width: 0,
  });
}
