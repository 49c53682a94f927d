/** Moving, resizing and lining up what is drawn. Coordinates are those of the container; of parts those of their state. */

import { type ElementRef, layoutElement } from "../model/element.ts";
import type { Edit } from "../model/generated/protocol.ts";
import { type Box, boundsOf, type Point, type Size } from "../model/geometry.ts";
import { changed } from "../model/layout.ts";
import { nameBox, onBorder, readLayout } from "../model/layout_reader.ts";
import { dataFlowsOf, type Machine, startOf, transitionsOf } from "../model/machine.ts";
import { childPath, idOf, parentOf } from "../model/path.ts";
import {
  allowedShift,
  boxEdits,
  boxIn,
  childBoxes,
  inside,
  lineRoom,
  pins,
  positionEdit,
  sizeEdit,
  sizeIn,
  waypointsEdit,
} from "./boxes.ts";
import { commonContainer, containerAt, counted, stateAt } from "./legal.ts";
import { newId } from "./newcomers.ts";
import { isRefused, type Planned, type Refused, refused, together } from "./plan.ts";
import { minimum, resizeEdits, scaleInside } from "./resize.ts";
import { keptRightAngles } from "./right_angles.ts";

/** Largest common move of states. They stay in their container, with space for lines at its border. */
export function allowedMove(machine: Machine, paths: readonly string[], by: Point): Point {
  const container = commonContainer(machine, paths);
  if (typeof container !== "string") return by;
  const bounds = boundsOf(paths.map((path) => boxIn(machine, path)));
  return bounds ? allowedShift(bounds, sizeIn(machine, container), by) : by;
}

/** Moves states of one container; waypoints between them move along, those of lines to others keep their right angles. */
export function move(machine: Machine, paths: readonly string[], wanted: Point): Planned {
  const container = commonContainer(machine, paths);
  if (typeof container !== "string") return container;
  const by = allowedMove(machine, paths, wanted);
  const edits = paths.flatMap((path) => {
    const state = machine.state(path);
    const box = boxIn(machine, path);
    return state ? boxEdits(state, path, { ...box, x: box.x + by.x, y: box.y + by.y }) : [];
  });
  if (by.x === 0 && by.y === 0) return refused("The states do not move.");
  const lines = keptRightAngles(machine, [container], edits);
  return { name: `Move ${statesInWords(machine, paths)}`, edit: together([...edits, ...lines]) };
}

/** `Scan`, `3 states`. */
export function statesInWords(machine: Machine, paths: readonly string[]): string {
  const [only] = paths;
  if (paths.length === 1 && only !== undefined) return machine.state(only)?.name ?? "state";
  return counted(paths.length, "state");
}

/** Puts states of one container into another; the left top corner of them all at the point, in the other's coordinates. They
 * are made smaller if they are too large for it. */
export function moveInto(
  machine: Machine,
  paths: readonly string[],
  container: string,
  at: Point,
): Planned {
  const from = commonContainer(machine, paths);
  if (typeof from !== "string") return from;
  const target = containerAt(machine, container);
  if (isRefused(target)) return target;
  if (from === container) return refused(`The states are already in ${target.name}.`);
  const own = paths.find((path) => container === path || container.startsWith(`${path}/`));
  if (own !== undefined) {
    return refused(`${machine.state(own)?.name} cannot be inside itself. Choose another place.`);
  }
  const ids = arrivingIds(machine, container, paths.map(idOf));
  // Positions first, because they are set at the earlier paths.
  const edits: Edit[] = [
    ...pins(machine, container, new Set()),
    ...pins(machine, from, new Set(paths)),
    ...placedAt(machine, paths, sizeIn(machine, container), at),
    { edit: "move_states", path: from, states: paths.map(idOf), to: container, ids: [...ids] },
  ];
  const entry = entryAmong(machine, from, paths);
  const start = ids[entry];
  const isEmpty = machine.children(container).length === 0 && !startOf(target);
  if (target.kind === "hierarchy" && isEmpty && start !== undefined) {
    edits.push({ edit: "set_start", path: container, to: { state: start } });
  }
  return {
    name: `Move ${statesInWords(machine, paths)} into ${target.name}`,
    edit: together(edits),
    select: ids.map((id) => ({ kind: "state", path: childPath(container, id) })),
  };
}

/** Which of these states the others come after: the start of their container, else the first to which none of them leads. */
function entryAmong(machine: Machine, container: string, paths: readonly string[]): number {
  const state = machine.state(container);
  const ids = paths.map(idOf);
  const start = state ? startOf(state)?.to_state : undefined;
  if (start != null && ids.includes(start)) return ids.indexOf(start);
  const led = new Set(
    (state ? transitionsOf(state) : []).flatMap(({ from_state, to_state }) =>
      ids.includes(from_state ?? "") ? [to_state] : [],
    ),
  );
  return Math.max(
    0,
    ids.findIndex((id) => !led.has(id)),
  );
}

/** Number of connections that states lose in another container. Connections between them are moved. */
export function lostConnections(machine: Machine, paths: readonly string[]): number {
  const container = commonContainer(machine, paths);
  const state = typeof container === "string" ? machine.state(container) : undefined;
  if (!state) return 0;
  const ids = new Set(paths.map(idOf));
  const isCut = (line: { from_state?: string | null; to_state?: string | null }) =>
    ids.has(line.from_state ?? "") !== ids.has(line.to_state ?? "");
  return [...transitionsOf(state), ...dataFlowsOf(state)].filter(isCut).length;
}

/** Ids for states that come to a container: their own where those are free. */
export function arrivingIds(
  machine: Machine,
  container: string,
  ids: readonly string[],
): readonly string[] {
  const taken = new Set([...machine.children(container).map(idOf), idOf(container)]);
  return ids.map((id) => {
    const free = taken.has(id) ? newId(machine, container, taken) : id;
    taken.add(free);
    return free;
  });
}

function placedAt(machine: Machine, paths: readonly string[], size: Size, at: Point): Edit[] {
  const bounds = boundsOf(paths.map((path) => boxIn(machine, path)));
  if (!bounds) return [];
  const factor = Math.min(
    1,
    (0.8 * size.width) / bounds.width,
    (0.8 * size.height) / bounds.height,
  );
  const whole = inside(
    { ...at, width: bounds.width * factor, height: bounds.height * factor },
    size,
    lineRoom(size),
  );
  return paths.flatMap((path) => {
    const box = boxIn(machine, path);
    const to = {
      x: whole.x + (box.x - bounds.x) * factor,
      y: whole.y + (box.y - bounds.y) * factor,
      width: box.width * factor,
      height: box.height * factor,
    };
    const state = machine.state(path);
    if (!state) return [];
    return factor === 1
      ? boxEdits(state, path, to)
      : scaleInside(machine, path, to, { x: factor, y: factor });
  });
}

/** Gives a state another box. With its content everything inside is scaled; otherwise it stays where it shows. */
export function resize(machine: Machine, path: string, box: Box, withContent: boolean): Planned {
  const state = stateAt(machine, path);
  if (isRefused(state)) return state;
  const wanted = allowedBox(machine, path, box, withContent);
  const name = `Resize ${state.name}${withContent ? " with its content" : ""}`;
  const edits = resizeEdits(machine, path, wanted, withContent);
  const parent = parentOf(path);
  const touched = [...(parent === null ? [] : [parent]), ...(withContent ? [] : [path])];
  return { name, edit: together([...edits, ...keptRightAngles(machine, touched, edits)]) };
}

/** One of the four numbers of a state's box. */
interface BoxSide {
  readonly side: keyof Box;
  readonly value: number;
}

/** Moves a state to a coordinate, as far as it may be moved, or gives it another width or height. */
export function setSide(
  machine: Machine,
  path: string,
  { side, value }: BoxSide,
  withContent: boolean,
): Planned {
  const box = boxIn(machine, path);
  if (side === "width" || side === "height") {
    return resize(machine, path, { ...box, [side]: value }, withContent);
  }
  return move(machine, [path], { x: 0, y: 0, [side]: value - box[side] });
}

/** The box that a state may have at most and at least: inside its container, around its content. */
export function allowedBox(machine: Machine, path: string, box: Box, withContent: boolean): Box {
  const old = boxIn(machine, path);
  const least = minimum(machine, path, withContent);
  const parent = parentOf(path);
  const size = parent === null ? null : sizeIn(machine, parent);
  const [x, width] = span(box.x, box.width, least.width, size?.width ?? null, old.x !== box.x);
  const [y, height] = span(box.y, box.height, least.height, size?.height ?? null, old.y !== box.y);
  return { x, y, width, height };
}

/** Start and length of a side, within limits; `fromStart` if it is the start that is dragged. */
function span(
  start: number,
  length: number,
  least: number,
  room: number | null,
  fromStart: boolean,
): [number, number] {
  const end = start + length;
  if (fromStart) {
    const begin = Math.min(room === null ? start : Math.max(0, start), end - least);
    return [begin, end - begin];
  }
  const last = Math.max(room === null ? end : Math.min(room, end), start + least);
  return [start, last - start];
}

/** Puts an outcome, port or income elsewhere on the border, in the coordinates of its state. */
export function movePort(machine: Machine, element: ElementRef, at: Point): Planned {
  const state = stateAt(machine, element.path);
  if (isRefused(state)) return state;
  const place = onBorder(at, sizeIn(machine, element.path));
  const edit = positionEdit(element.path, layoutElement(element), place);
  const parent = parentOf(element.path);
  const touched = parent === null ? [element.path] : [parent, element.path];
  const lines = keptRightAngles(machine, touched, [edit]);
  const name = `Move ${element.kind.replace("_", " ")} of ${state.name}`;
  return { name, edit: together([edit, ...lines]) };
}

/** Puts the name of a state elsewhere. */
export function moveName(machine: Machine, path: string, box: Box): Planned {
  return nameEdit(machine, path, box, "Move");
}

export function resizeName(machine: Machine, path: string, box: Box): Planned {
  return nameEdit(machine, path, box, "Resize");
}

function nameEdit(machine: Machine, path: string, box: Box, verb: string): Planned {
  const state = stateAt(machine, path);
  if (isRefused(state)) return state;
  const size = sizeIn(machine, path);
  const least = Math.min(size.width, size.height) / 8;
  const width = Math.min(size.width, Math.max(least, box.width));
  const height = Math.min(size.height, Math.max(least, box.height));
  const place = inside({ x: box.x, y: box.y, width, height }, size);
  const before = nameBox(state, size);
  const isSized = before.width === width && before.height === height && readLayout(state).nameBox;
  const edits = [positionEdit(path, "name", place)];
  if (!isSized) edits.push(sizeEdit(path, "name", place));
  return { name: `${verb} the name of ${state.name}`, edit: together(edits) };
}

/** Sets the waypoints of a transition or data flow; an empty list makes it straight. */
export function setWaypoints(
  machine: Machine,
  element: ElementRef,
  points: readonly Point[],
): Planned {
  const state = stateAt(machine, element.path);
  if (isRefused(state)) return state;
  if (element.kind !== "transition" && element.kind !== "data_flow") {
    return refused("Only transitions and data flows have waypoints.");
  }
  const size = sizeIn(machine, element.path);
  const within = points.map(({ x, y }) => ({
    x: Math.min(size.width, Math.max(0, x)),
    y: Math.min(size.height, Math.max(0, y)),
  }));
  const what = element.kind === "transition" ? "transition" : "data flow";
  const name = points.length === 0 ? `Straighten ${what}` : `Reroute ${what}`;
  return { name, edit: waypointsEdit(element.path, layoutElement(element), within) };
}

export type Alignment = "left" | "right" | "top" | "bottom" | "centre" | "middle";

const ALIGNED: Readonly<Record<Alignment, (box: Box, all: Box) => Point>> = {
  left: (box, all) => ({ x: all.x, y: box.y }),
  right: (box, all) => ({ x: all.x + all.width - box.width, y: box.y }),
  centre: (box, all) => ({ x: all.x + (all.width - box.width) / 2, y: box.y }),
  top: (box, all) => ({ x: box.x, y: all.y }),
  bottom: (box, all) => ({ x: box.x, y: all.y + all.height - box.height }),
  middle: (box, all) => ({ x: box.x, y: all.y + (all.height - box.height) / 2 }),
};

/** Puts states of one container on one line: a side of them, or their middles. */
export function align(machine: Machine, paths: readonly string[], to: Alignment): Planned {
  const boxes = boxesOf(machine, paths, 2);
  if (isRefused(boxes)) return boxes;
  const all = boundsOf(boxes.values());
  if (!all) return refused("No state is selected: choose two or more states.");
  const moved = [...boxes].map(
    ([path, box]) => [path, { ...box, ...ALIGNED[to](box, all) }] as const,
  );
  return placed(machine, new Map(moved), `Align ${counted(paths.length, "state")}`);
}

/** Gives states of one container even gaps; the outermost stay. */
export function distribute(
  machine: Machine,
  paths: readonly string[],
  along: "horizontal" | "vertical",
): Planned {
  const boxes = boxesOf(machine, paths, 3);
  if (isRefused(boxes)) return boxes;
  const [start, length] =
    along === "horizontal" ? (["x", "width"] as const) : (["y", "height"] as const);
  const sorted = [...boxes].sort(([, one], [, other]) => one[start] - other[start]);
  const all = boundsOf(boxes.values());
  if (!all) return refused("No state is selected: choose three or more states.");
  const used = sorted.reduce((sum, [, box]) => sum + box[length], 0);
  const gap = (all[length] - used) / (sorted.length - 1);
  let next = all[start];
  const moved = sorted.map(([path, box]) => {
    const to = { ...box, [start]: next };
    next += box[length] + gap;
    return [path, to] as const;
  });
  return placed(machine, new Map(moved), `Distribute ${counted(paths.length, "state")}`);
}

function boxesOf(
  machine: Machine,
  paths: readonly string[],
  least: number,
): ReadonlyMap<string, Box> | Refused {
  const container = commonContainer(machine, paths);
  if (typeof container !== "string") return container;
  if (paths.length < least) {
    return refused(`Select ${least === 2 ? "two" : "three"} or more states of one container.`);
  }
  const all = childBoxes(machine, container);
  return new Map(
    paths.flatMap((path) => {
      const box = all.get(path);
      return box ? [[path, box] as const] : [];
    }),
  );
}

function placed(machine: Machine, boxes: ReadonlyMap<string, Box>, name: string): Planned {
  const edits = [...boxes].flatMap(([path, box]) => {
    const state = machine.state(path);
    return state ? boxEdits(state, path, box) : [];
  });
  if (edits.length === 0) return refused("The states are already aligned like this.");
  const containers = new Set([...boxes.keys()].flatMap((path) => parentOf(path) ?? []));
  return { name, edit: together([...edits, ...keptRightAngles(machine, [...containers], edits)]) };
}

/** Gives a state a colour of its own (red, green and blue from 0 to 255), or takes it away. */
export function setBackground(
  machine: Machine,
  path: string,
  rgb: readonly [number, number, number] | null,
): Planned {
  const state = stateAt(machine, path);
  if (isRefused(state)) return state;
  const background = rgb && ([rgb[0] / 255, rgb[1] / 255, rgb[2] / 255] as const);
  const layout = changed(state.layout, { background });
  return { name: `Colour ${state.name}`, edit: { edit: "set_layout", path, layout } };
}

/** Sets the visibility of a library state's content for all users. */
export function showContent(machine: Machine, path: string, shown: boolean): Planned {
  const state = stateAt(machine, path);
  if (isRefused(state)) return state;
  if (state.kind !== "library")
    return refused(`${state.name} is not a library: its content is always shown.`);
  const layout = changed(state.layout, { showsContent: shown });
  const name = `${shown ? "Show" : "Hide"} content of ${state.name}`;
  return { name, edit: { edit: "set_layout", path, layout } };
}
