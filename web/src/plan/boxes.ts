/** Positions of states in their containers, stored or not, and the edits that move them. */

import { childBoxesOf } from "../model/default_places.ts";
import type { Edit, Element, StateDocument } from "../model/generated/protocol.ts";
import type { Box, Point, Size } from "../model/geometry.ts";
import { rounded } from "../model/layout.ts";
import { readLayout, rootSize } from "../model/layout_reader.ts";
import type { Machine } from "../model/machine.ts";
import { parentOf } from "../model/path.ts";

/** The box of a state in the coordinates of its container. */
export function boxIn(machine: Machine, path: string): Box {
  const state = machine.state(path);
  const parent = parentOf(path);
  if (!state) return { x: 0, y: 0, width: 0, height: 0 };
  const { position, size } = readLayout(state);
  if (position && size) return { ...position, ...size };
  if (parent === null) return { x: 0, y: 0, ...position, ...rootSize(state) };
  return childBoxes(machine, parent).get(path) ?? { x: 0, y: 0, width: 0, height: 0 };
}

/** The size of a state, in the coordinates of its container and its own. */
export function sizeIn(machine: Machine, path: string): Size {
  const { width, height } = boxIn(machine, path);
  return { width, height };
}

/** The boxes of all children by path. */
export function childBoxes(machine: Machine, container: string): ReadonlyMap<string, Box> {
  const known = knownBoxes(machine);
  const found = known.get(container) ?? findChildBoxes(machine, container);
  known.set(container, found);
  return found;
}

/** Boxes of children by container, as of a version of the machine. */
interface KnownBoxes {
  readonly version: number;
  readonly byContainer: Map<string, ReadonlyMap<string, Box>>;
}

const KNOWN = new WeakMap<Machine, KnownBoxes>();

function knownBoxes(machine: Machine): KnownBoxes["byContainer"] {
  const { version } = machine;
  let known = KNOWN.get(machine);
  if (known?.version !== version) known = { version, byContainer: new Map() };
  KNOWN.set(machine, known);
  return known.byContainer;
}

function findChildBoxes(machine: Machine, container: string): ReadonlyMap<string, Box> {
  const paths = machine.children(container);
  const states = paths.map((path) => machine.state(path));
  const boxes = childBoxesOf(states, sizeIn(machine, container));
  return new Map(
    paths.flatMap((path, index) => {
      const box = boxes[index];
      return box && states[index] ? [[path, box] as const] : [];
    }),
  );
}

export function positionEdit(path: string, element: Element, { x, y }: Point): Edit {
  return { edit: "set_position", path, element, position: [rounded(x), rounded(y)] };
}

export function sizeEdit(path: string, element: Element, { width, height }: Size): Edit {
  return { edit: "set_size", path, element, size: [rounded(width), rounded(height)] };
}

export function waypointsEdit(path: string, element: Element, points: readonly Point[]): Edit {
  const waypoints = points.map(({ x, y }): [number, number] => [rounded(x), rounded(y)]);
  return { edit: "set_waypoints", path, element, waypoints };
}

/** True if the file has the position of the state in the present form. */
function isPlaced(state: StateDocument): boolean {
  const gui = state.layout?.["gui"];
  const { position, size } = readLayout(state);
  return !!position && !!size && typeof gui === "object" && gui !== null && "editor_gaphas" in gui;
}

/** Edits that move a state into a box. `at` is its path by then, if it differs. */
export function boxEdits(state: StateDocument, path: string, box: Box): Edit[] {
  const { position, size, nameBox } = readLayout(state);
  const edits: Edit[] = [];
  if (!isPlaced(state) || position?.x !== box.x || position.y !== box.y) {
    edits.push(positionEdit(path, "state", box));
  }
  if (!isPlaced(state) || size?.width !== box.width || size.height !== box.height) {
    edits.push(sizeEdit(path, "state", box));
  }
  if (!isPlaced(state) && nameBox) {
    edits.push(positionEdit(path, "name", nameBox), sizeEdit(path, "name", nameBox));
  }
  return edits;
}

/** Edits that store the shown positions of children before others are added, removed or moved. */
export function pins(machine: Machine, container: string, without: ReadonlySet<string>): Edit[] {
  const edits: Edit[] = [];
  for (const [path, box] of childBoxes(machine, container)) {
    const state = machine.state(path);
    if (state && !without.has(path) && !readLayout(state).position) {
      edits.push(...boxEdits(state, path, box));
    }
  }
  return edits;
}

/** The box, moved into a container of this size with a margin, as far as it fits. */
export function inside(box: Box, container: Size, margin = 0): Box {
  const kept = (at: number, length: number, room: number) => {
    const [least, most] = span(length, room, margin);
    return Math.max(least, Math.min(at, most));
  };
  const x = kept(box.x, box.width, container.width);
  const y = kept(box.y, box.height, container.height);
  return { ...box, x, y };
}

/** Least and largest start of a side in a container with a margin, which is smaller where the side would not fit. */
function span(length: number, room: number, margin: number): readonly [number, number] {
  const least = Math.min(margin, Math.max(0, (room - length) / 2));
  return [least, room - length - least];
}

/** Room for lines between states and the border, as a part of the container's shorter side. */
const LINE_ROOM = 0.04;

/** Room for lines between states and the border of their container. */
export function lineRoom({ width, height }: Size): number {
  return Math.min(width, height) * LINE_ROOM;
}

/** Largest move of a box in its container. The border keeps space for lines, unless the box is already closer. */
export function allowedShift(box: Box, container: Size, by: Point): Point {
  const allowed = (wanted: number, at: number, length: number, room: number) => {
    const [least, most] = span(length, room, lineRoom(container));
    return Math.max(Math.min(least - at, 0), Math.min(Math.max(most - at, 0), wanted));
  };
  return {
    x: allowed(by.x, box.x, box.width, container.width),
    y: allowed(by.y, box.y, box.height, container.height),
  };
}

/** Edits that move states of one container by one offset. */
export function shiftedChildren(machine: Machine, paths: readonly string[], by: Point): Edit[] {
  return paths.flatMap((path) => {
    const state = machine.state(path);
    const box = boxIn(machine, path);
    return state ? boxEdits(state, path, { ...box, x: box.x + by.x, y: box.y + by.y }) : [];
  });
}
