/** Grouping and substituting: everything keeps its place on the screen. */

import type { Edit, StateDocument, TransitionDocument } from "../model/generated/protocol.ts";
import {
  type Box,
  boundsOf,
  contains,
  intersects,
  type Point,
  type Size,
} from "../model/geometry.ts";
import { changed } from "../model/layout.ts";
import { readLayout, rootSize } from "../model/layout_reader.ts";
import { type Machine, outcomesOf, portsOf, transitionsOf } from "../model/machine.ts";
import { childPath, idOf } from "../model/path.ts";
import { boxIn, childBoxes, pins, shiftedChildren, sizeIn, waypointsEdit } from "./boxes.ts";
import { drawnInto, underId } from "./documents.ts";
import { commonContainer, containerAt, movableFrom } from "./legal.ts";
import { statesInWords } from "./move.ts";
import { newBox, newId, newName } from "./newcomers.ts";
import { isRefused, type Planned, type Refused, refused, together } from "./plan.ts";
import { scaleInside } from "./resize.ts";
import { isStoredRightAngled, leadsThrough, storedWay } from "./right_angles.ts";
import { added } from "./states.ts";

/** Puts states of one container, and scoped variables of it that are named, into a new hierarchy around them. */
export function group(
  machine: Machine,
  paths: readonly string[],
  scoped: readonly number[] = [],
): Planned {
  const path = commonContainer(machine, paths);
  if (typeof path !== "string") return path;
  const container = containerAt(machine, path);
  if (isRefused(container)) return container;
  const ids = new Set(paths.map(idOf));
  const bad = entriesRefused(machine, path, container, ids);
  if (bad) return bad;
  const id = newId(machine, path);
  const name = newName(machine, path, "Group");
  const place = groupPlace(machine, path, paths);
  const { box, nameBox } = place;
  const waypoints = groupedWaypoints(machine, path, container, ids, place);
  const layout = changed(null, { position: box, size: box, nameBox, waypoints: waypoints.inner });
  const edits: Edit[] = [
    ...pins(machine, path, new Set(paths)),
    ...grouped(machine, paths, place),
    { edit: "group", path, states: [...ids], scoped_variables: [...scoped], id, name },
    { edit: "set_layout", path: childPath(path, id), layout },
    ...waypoints.outer,
  ];
  return {
    name: `Group ${statesInWords(machine, paths)}`,
    edit: together(edits),
    select: [{ kind: "state", path: childPath(path, id) }],
  };
}

/** Converts a point of the container to the group. */
function inGroup({ x, y }: Point, { box, bounds, content }: GroupPlace): Point {
  const factor = content.width / bounds.width;
  return {
    x: content.x - box.x + (x - bounds.x) * factor,
    y: content.y - box.y + (y - bounds.y) * factor,
  };
}

function grouped(machine: Machine, paths: readonly string[], place: GroupPlace): Edit[] {
  const { box, bounds, content } = place;
  const factor = content.width / bounds.width;
  if (factor === 1) return shiftedChildren(machine, paths, { x: -box.x, y: -box.y });
  return paths.flatMap((path) => {
    const { width, height, ...at } = boxIn(machine, path);
    const to = { ...inGroup(at, place), width: width * factor, height: height * factor };
    return scaleInside(machine, path, to, { x: factor, y: factor });
  });
}

function entriesRefused(
  machine: Machine,
  path: string,
  container: StateDocument,
  ids: ReadonlySet<string>,
): Refused | null {
  const entries = transitionsOf(container).filter((each) => isEntry(each, ids));
  const targets = [...new Set(entries.map(({ to_state }) => to_state ?? ""))];
  const [one, other] = targets.map((id) => machine.state(childPath(path, id))?.name ?? id);
  if (one === undefined || other === undefined) return null;
  return refused(
    `Transitions from outside lead to both ${one} and ${other}, but a group has only one start: group other states, or remove one of these transitions first.`,
  );
}

function isEntry(transition: TransitionDocument, ids: ReadonlySet<string>): boolean {
  const { from_state, to_state, to_outcome } = transition;
  return to_outcome == null && ids.has(to_state ?? "") && !ids.has(from_state ?? "");
}

/** Position of a group, and positions of its content. */
interface GroupPlace {
  readonly box: Box;
  readonly nameBox: Box | undefined;
  /** Bounds of the states, and their new bounds, both in the coordinates of the container. */
  readonly bounds: Box;
  readonly content: Box;
}

/** Width of a group's border as a fraction of the preferred one, less in little space. */
const BORDERS = [1, 0.7, 0.5, 0.35];

/** The box around the states, with a border and room for the name, clear of the other states. Where there is no room for that,
 * the content is made smaller. */
function groupPlace(machine: Machine, container: string, paths: readonly string[]): GroupPlace {
  const room = sizeIn(machine, container);
  const boxes = paths.map((path) => boxIn(machine, path));
  const bounds = boundsOf(boxes) ?? { x: 0, y: 0, ...room };
  const others = [...childBoxes(machine, container)].flatMap(([path, box]) =>
    paths.includes(path) ? [] : [box],
  );
  const isFree = (box: Box) => !others.some((other) => intersects(box, other));
  const box = BORDERS.map((part) => bordered(bounds, room, part)).find(isFree);
  if (box) {
    const nameBox = nameStrip(box, bounds.y - box.y);
    return { box, nameBox, bounds, content: bounds };
  }
  const frame = isFree(bounds) ? bounds : largest(boxes, bounds);
  const content = fittedInto(bounds, frame);
  return { box: frame, nameBox: nameStrip(frame, content.y - frame.y), bounds, content };
}

function bordered(bounds: Box, room: Size, part: number): Box {
  const border = Math.max(bounds.width, bounds.height) * 0.1 * part;
  const left = Math.min(bounds.x, Math.max(0, bounds.x - border));
  const top = Math.min(bounds.y, Math.max(0, bounds.y - 2 * border));
  const right = bounds.x + bounds.width;
  const bottom = bounds.y + bounds.height;
  const width = Math.max(right, Math.min(room.width, right + border)) - left;
  const height = Math.max(bottom, Math.min(room.height, bottom + border)) - top;
  return { x: left, y: top, width, height };
}

function largest(boxes: readonly Box[], otherwise: Box): Box {
  const area = ({ width, height }: Box) => width * height;
  return boxes.reduce((best, box) => (area(box) > area(best) ? box : best), boxes[0] ?? otherwise);
}

/** The form of the bounds inside a frame, below room for the name. */
function fittedInto(bounds: Size, frame: Box): Box {
  const inner = { width: frame.width * 0.84, height: frame.height * 0.7 };
  const factor = Math.min(inner.width / bounds.width, inner.height / bounds.height);
  const [width, height] = [bounds.width * factor, bounds.height * factor];
  const x = frame.x + (frame.width - width) / 2;
  return { x, y: frame.y + frame.height * 0.22 + (inner.height - height) / 2, width, height };
}

/** The name above the content, if there is any room. */
function nameStrip(size: Size, height: number): Box | undefined {
  if (height < size.height * 0.02) return undefined;
  const inset = height * 0.15;
  return {
    x: inset,
    y: inset,
    width: Math.max(inset, size.width - 2 * inset),
    height: height - 2 * inset,
  };
}

interface GroupWaypoints {
  readonly inner: ReadonlyMap<string, readonly Point[]>;
  readonly outer: Edit[];
}

/** Moves waypoints inside the box. Lines with right angles that cross the border are routed again; freely drawn lines are cut at the
 * border. */
function groupedWaypoints(
  machine: Machine,
  path: string,
  container: StateDocument,
  ids: ReadonlySet<string>,
  place: GroupPlace,
): GroupWaypoints {
  const inner = new Map<string, readonly Point[]>();
  const outer: Edit[] = [];
  const exits = new Set<string>();
  for (const transition of transitionsOf(container)) {
    const { id, from_state, to_state, to_outcome } = transition;
    const leaves = ids.has(from_state ?? "");
    const goal = JSON.stringify([to_state, to_outcome]);
    const isSecond = leaves && exits.has(goal);
    if (leaves) exits.add(goal);
    const staysInside = leaves && ids.has(to_state ?? "") && to_outcome == null;
    const isCut = !staysInside && (leaves || isEntry(transition, ids));
    const cut = cutAt(machine, path, transition, place, isCut);
    if (leaves && cut.within.length > 0) inner.set(`transition${id}`, cut.within);
    if (cut.beyond && !staysInside && !isSecond) {
      outer.push(waypointsEdit(path, { transition: id }, cut.beyond));
    }
  }
  return { inner, outer };
}

interface CutWay {
  /** Bends inside the group, in its coordinates. */
  readonly within: readonly Point[];
  /** Bends outside; null: as before. */
  readonly beyond: readonly Point[] | null;
}

/** Rest of a stored way after grouping; `isCut` if the line crosses the border. */
function cutAt(
  machine: Machine,
  path: string,
  line: TransitionDocument,
  place: GroupPlace,
  isCut: boolean,
): CutWay {
  const points = storedWay(machine, path, line);
  if (points.length === 0) return { within: [], beyond: null };
  const box = place.content === place.bounds ? place.box : place.bounds;
  const within = points.filter((point) => contains(box, point));
  const moved = within.map((point) => inGroup(point, place));
  if (!isStoredRightAngled(machine, path, line)) {
    const beyond = points.filter((point) => !contains(box, point));
    return { within: moved, beyond: isCut ? beyond : null };
  }
  if (isCut) return { within: [], beyond: [] };
  const isWhole = within.length === points.length;
  const isThrough = leadsThrough(machine, path, line, place.box);
  return { within: isWhole ? moved : [], beyond: isThrough ? [] : null };
}

/** Puts other states in the place of a state: its box and the places of its ports stay, connections where names fit. */
export function substitute(
  machine: Machine,
  path: string,
  states: readonly StateDocument[],
  keepName: boolean,
): Planned {
  const container = movableFrom(machine, path);
  if (typeof container !== "string") return container;
  const old = machine.state(path);
  const [model] = states;
  if (!old || !model) return refused("There is nothing to replace the state with.");
  if (model.kind === "decider") return deciderRefused();
  const clash = states.some(({ path: inner }) => inner === `${model.path}/${idOf(path)}`);
  const id = clash ? newId(machine, container) : idOf(path);
  const [first, ...rest] = drawnInto(underId(states, id), boxIn(machine, path));
  if (!first) return refused("There is nothing to replace the state with.");
  const name = keepName ? old.name : model.name;
  const layout = changed(first.layout, { ports: portsFrom(old, first) });
  const edits: Edit[] = [
    ...pins(machine, container, new Set([path])),
    {
      edit: "substitute_state",
      path: container,
      state: idOf(path),
      states: [{ ...first, name, layout }, ...rest],
    },
  ];
  return {
    name: `Substitute ${old.name} by ${model.name}`,
    edit: together(edits),
    select: [{ kind: "state", path: childPath(container, id) }],
  };
}

function deciderRefused(): Refused {
  return refused("A decider belongs to its barrier: choose another state, or the barrier.");
}

/** Positions of the old ports for new ports with their names. */
function portsFrom(old: StateDocument, now: StateDocument): ReadonlyMap<string, Point> {
  const { ports } = readLayout(old);
  const found = new Map<string, Point>();
  const take = (
    prefix: string,
    before: readonly { id: number; name: string }[],
    after: readonly { id: number; name: string }[],
  ) => {
    for (const { id, name } of after) {
      const twin = before.find((other) => other.name === name);
      const at = twin && ports.get(`${prefix}${twin.id}`);
      if (at) found.set(`${prefix}${id}`, at);
    }
  };
  const income = ports.get("income");
  if (income) found.set("income", income);
  take("outcome", outcomesOf(old), outcomesOf(now));
  take("input_data_port", portsOf(old, "input"), portsOf(now, "input"));
  take("output_data_port", portsOf(old, "output"), portsOf(now, "output"));
  return found;
}

/** Adds a copy of states, the first around the others, with its middle at a point, or where there is room. */
export function addTemplate(
  machine: Machine,
  container: string,
  states: readonly StateDocument[],
  at?: Point,
): Planned {
  const around = containerAt(machine, container);
  if (isRefused(around)) return around;
  const [model] = states;
  if (!model) return refused("There is nothing to copy.");
  if (model.kind === "decider") return deciderRefused();
  const size = rootSize(model);
  const box = newBox(machine, container, at, size.width / size.height);
  const id = newId(machine, container);
  const name = newName(machine, container, model.name);
  const copies = drawnInto(underId(states, id), box);
  const [first, ...rest] = copies;
  if (!first) return refused("There is nothing to copy.");
  return added(
    machine,
    container,
    around,
    [{ ...first, name }, ...rest],
    `Add copy of ${model.name}`,
  );
}
