/** Edits that resize a state and adapt the positions on its border and inside it. */

import type { Edit, StateDocument } from "../model/generated/protocol.ts";
import type { Box, Point, Size } from "../model/geometry.ts";
import { changed, scaledBox, scaledLayout } from "../model/layout.ts";
import { readLayout } from "../model/layout_reader.ts";
import { isContainer, type Machine } from "../model/machine.ts";
import { parentOf } from "../model/path.ts";
import { boxEdits, boxIn, childBoxes, sizeIn } from "./boxes.ts";

interface Factor {
  readonly x: number;
  readonly y: number;
}

/** The smallest size that a state may be given. */
export function minimum(machine: Machine, path: string, withContent: boolean): Size {
  const parent = parentOf(path);
  const around = parent === null ? { width: 1, height: 1 } : sizeIn(machine, parent);
  const least = Math.min(around.width, around.height) / 50;
  const state = machine.state(path);
  if (withContent || !state || !isContainer(state)) return { width: least, height: least };
  let [width, height] = [least, least];
  for (const box of childBoxes(machine, path).values()) {
    width = Math.max(width, box.width);
    height = Math.max(height, box.height);
  }
  return { width, height };
}

export function resizeEdits(
  machine: Machine,
  path: string,
  box: Box,
  withContent: boolean,
): Edit[] {
  const state = machine.state(path);
  if (!state) return [];
  const old = boxIn(machine, path);
  const factor = { x: box.width / old.width, y: box.height / old.height };
  if (withContent) return scaleInside(machine, path, box, factor);
  const edits: Edit[] = [
    { edit: "set_layout", path, layout: resizedLayout(state, old, box, factor) },
  ];
  if (!isContainer(state)) return edits;
  const by = { x: old.x - box.x, y: old.y - box.y };
  return [...edits, ...keptChildren(machine, path, box, by)];
}

/** Ports keep their part of the border; waypoints stay where they show. */
function resizedLayout(state: StateDocument, old: Box, box: Box, factor: Factor) {
  const { ports, waypoints, nameBox } = readLayout(state);
  const by = { x: old.x - box.x, y: old.y - box.y };
  return changed(state.layout, {
    position: box,
    size: box,
    nameBox: nameBox && scaledBox(nameBox, factor),
    ports: new Map(
      [...ports].map(([key, at]) => [key, { x: at.x * factor.x, y: at.y * factor.y }]),
    ),
    waypoints: new Map(
      [...waypoints].map(([key, points]) => [key, points.map((at) => shifted(at, by))]),
    ),
  });
}

function shifted(at: Point, by: Point): Point {
  return { x: at.x + by.x, y: at.y + by.y };
}

/** Children stay where they show, but inside. */
function keptChildren(machine: Machine, path: string, size: Size, by: Point): Edit[] {
  const edits: Edit[] = [];
  for (const [child, box] of childBoxes(machine, path)) {
    const state = machine.state(child);
    const at = shifted(box, by);
    const x = Math.max(0, Math.min(at.x, size.width - box.width));
    const y = Math.max(0, Math.min(at.y, size.height - box.height));
    if (state) edits.push(...boxEdits(state, child, { ...box, x, y }));
  }
  return edits;
}

/** Puts a state into a box and scales everything on and in it, on all levels; content of libraries is drawn to fit. */
export function scaleInside(machine: Machine, path: string, box: Box, factor: Factor): Edit[] {
  const state = machine.state(path);
  if (!state) return [];
  const edits: Edit[] = [{ edit: "set_layout", path, layout: scaledLayout(state, box, factor) }];
  if (!isContainer(state)) return edits;
  for (const [child, inner] of childBoxes(machine, path)) {
    edits.push(...scaleInside(machine, child, scaledBox(inner, factor), factor));
  }
  return edits;
}
