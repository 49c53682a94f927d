/** Copying, pasting and duplicating: states with what connects them, and ports and outcomes beside them. */

import type { ElementRef } from "../model/element.ts";
import type { Edit, Selection, StateDocument } from "../model/generated/protocol.ts";
import { boundsOf, type Point } from "../model/geometry.ts";
import { waypointsOf } from "../model/layout_reader.ts";
import {
  dataFlowsOf,
  isContainer,
  type Machine,
  portsOf,
  startOf,
  transitionsOf,
} from "../model/machine.ts";
import { childPath, idOf, isWithin, parentOf } from "../model/path.ts";
import { boxIn, childBoxes, inside, lineRoom, pins, sizeIn, waypointsEdit } from "./boxes.ts";
import { besides, drawnBox, drawnInto, placedDocumentsOf, separate } from "./documents.ts";
import { commonContainer, containerAt, counted } from "./legal.ts";
import { arrivingIds, statesInWords } from "./move.ts";
import { type InterfacePart, partOf, partsOf, pasteParts } from "./parts.ts";
import { isRefused, type Plan, type Planned, type Refused, refused, together } from "./plan.ts";

/** All that can be on the clipboard. */
export interface Clip {
  /** States, and scoped variables of their container; null if there are none. */
  readonly selection: Selection | null;
  /** Waypoints of the connections of the selection. */
  readonly ways?: CopiedWaypoints | undefined;
  /** Ports and outcomes for themselves. */
  readonly parts: readonly InterfacePart[];
}

/** Waypoints of connections, in their order in the selection and in the coordinates of the container. */
export interface CopiedWaypoints {
  readonly transitions: readonly (readonly Point[])[];
  readonly data_flows: readonly (readonly Point[])[];
}

/** The parts of the elements that are copied. */
export function clipOf(machine: Machine, elements: readonly ElementRef[]): Clip | Refused {
  const states = elements.filter(({ kind }) => kind === "state");
  const selection = states.length > 0 ? copySelection(machine, elements) : null;
  const home = states.length > 0 ? commonest(elements) : null;
  const isAlong = ({ kind, path }: ElementRef) =>
    (kind === "scoped_variable" && path === home) ||
    states.some((state) => isWithin(path, state.path));
  const parts = partsOf(
    machine,
    elements.filter((element) => !isAlong(element)),
  );
  if (selection && !isRefused(selection)) {
    return {
      selection,
      ways: home === null ? undefined : copiedWaypoints(machine, home, selection),
      parts,
    };
  }
  if (parts.length > 0) return { selection: null, parts };
  return selection ?? refused(NOTHING);
}

const NOTHING =
  "Select states inside the machine, ports or own outcomes to copy. Every state has an income, aborted and preempted.";

/** Waypoints of the connections between copied elements. */
function copiedWaypoints(
  machine: Machine,
  container: string,
  selection: Selection,
): CopiedWaypoints | undefined {
  const state = machine.state(container);
  if (!state) return undefined;
  const points = (kind: "transition" | "data_flow") => (line: { readonly id: number }) =>
    waypointsOf(state, kind, line.id);
  const waypoints = {
    transitions: (selection.transitions ?? []).map(points("transition")),
    data_flows: (selection.data_flows ?? []).map(points("data_flow")),
  };
  return [...waypoints.transitions, ...waypoints.data_flows].some(({ length }) => length > 0)
    ? waypoints
    : undefined;
}

/** Target of a paste: a container for states, a state for ports and outcomes. */
interface PasteGoal {
  readonly container: { readonly path: string; readonly at?: Point } | null;
  readonly owner: string | null;
}

/** The ports and outcomes of what was copied, also scoped variables that came with states. */
export function partsIn({ selection, parts }: Clip): readonly InterfacePart[] {
  const variables = selection?.scoped_variables ?? [];
  return [...parts, ...variables.map((port) => partOf("scoped_variable", port))];
}

/** Pastes all that was copied; a state that holds no states gets the ports and outcomes only. */
export function pasteClip(machine: Machine, clip: Clip, { container, owner }: PasteGoal): Planned {
  const { selection, parts, ways: waypoints } = clip;
  const state = owner === null ? undefined : machine.state(owner);
  const takesParts = parts.length > 0 && state && !isContainer(state) && state.kind !== "library";
  if (owner !== null && (selection === null || takesParts)) {
    return pasteParts(machine, owner, parts);
  }
  if (container === null || selection === null) {
    return refused("Select the state to paste into.");
  }
  const states = paste(machine, container.path, selection, container.at, waypoints);
  if (isRefused(states) || parts.length === 0) return states;
  const more = pasteParts(machine, container.path, parts);
  if (isRefused(more)) return more;
  // Parts first, because their ids are used when the paste chooses free ones.
  const select = [...(states.select ?? []), ...(more.select ?? [])];
  return { name: states.name, edit: together([...editsIn(more), ...editsIn(states)]), select };
}

function editsIn({ edit }: Plan): readonly Edit[] {
  return edit.edit === "batch" ? edit.edits : [edit];
}

/** The states and scoped variables among the elements, of the container that has most of them, and what is between. */
export function copySelection(
  machine: Machine,
  elements: readonly ElementRef[],
): Selection | Refused {
  const container = commonest(elements);
  const state = container === null ? undefined : machine.state(container);
  if (container === null || !state) {
    return refused("Select states inside the machine, or scoped variables, to copy them.");
  }
  const own = elements.filter((element) => containerOf(element) === container);
  const paths = own
    .filter(({ kind, path }) => kind === "state" && machine.state(path)?.kind !== "decider")
    .map(({ path }) => path);
  const variables = own.flatMap((element) =>
    element.kind === "scoped_variable" ? [element.id] : [],
  );
  if (paths.length === 0 && variables.length === 0) {
    return refused("A decider belongs to its barrier: copy the barrier, or other states.");
  }
  const ids = new Set(paths.map(idOf));
  return {
    container: idOf(container),
    states: paths.flatMap((path) => placedDocumentsOf(machine, path)),
    scoped_variables: portsOf(state, "scoped_variable").filter(({ id }) => variables.includes(id)),
    ...between(state, idOf(container), ids, variables),
  };
}

/** The container of what can be copied. */
function containerOf({ kind, path }: ElementRef): string | null {
  if (kind === "state") return parentOf(path);
  return kind === "scoped_variable" ? path : null;
}

/** The container of most states; where there are none, of most scoped variables. */
function commonest(elements: readonly ElementRef[]): string | null {
  const counts = new Map<string, number>();
  const states = elements.filter(({ kind, path }) => kind === "state" && parentOf(path) !== null);
  for (const element of states.length > 0 ? states : elements) {
    const container = containerOf(element);
    if (container !== null) counts.set(container, (counts.get(container) ?? 0) + 1);
  }
  const most = [...counts].reduce<[string, number] | null>(
    (best, next) => (best && best[1] >= next[1] ? best : next),
    null,
  );
  return most?.[0] ?? null;
}

function between(
  state: StateDocument,
  container: string,
  ids: ReadonlySet<string>,
  variables: readonly number[],
) {
  const isEnd = (id: string, port: number) =>
    ids.has(id) || (id === container && variables.includes(port));
  return {
    transitions: transitionsOf(state).filter(
      ({ from_state, to_state }) => ids.has(from_state ?? "") && ids.has(to_state ?? ""),
    ),
    data_flows: dataFlowsOf(state).filter(
      (flow) => isEnd(flow.from_state, flow.from_port) && isEnd(flow.to_state, flow.to_port),
    ),
  };
}

/** Puts copied states into a container, their middle at the point, or else near where they were. They are made smaller if
 * they are too large for it. */
export function paste(
  machine: Machine,
  container: string,
  selection: Selection,
  at?: Point,
  waypoints?: CopiedWaypoints,
): Planned {
  return pasted(machine, container, { selection, ways: waypoints }, { middle: at }, "Paste");
}

interface Copied {
  readonly selection: Selection;
  readonly ways: CopiedWaypoints | undefined;
}

/** Position of the copies; by default near the originals. */
interface PastePlace {
  readonly middle?: Point | undefined;
  readonly corner?: Point | undefined;
}

function pasted(
  machine: Machine,
  container: string,
  { selection, ways: waypoints }: Copied,
  pastePlace: PastePlace,
  verb: string,
): Planned {
  const target = containerAt(machine, container);
  if (isRefused(target)) return target;
  const copies = separate(selection.states ?? []);
  const old = copies.map(([first]) => first?.path ?? "");
  const ids = arrivingIds(machine, container, old);
  const placement = placementFor(machine, container, copies, pastePlace);
  const states = placement
    ? copies.flatMap((copy, index) => into(copy, index, placement))
    : copies.flat();
  const count = copies.length + (selection.scoped_variables?.length ?? 0);
  if (count === 0)
    return refused("Nothing has been copied yet: select states and copy them first.");
  const what = copies.length > 0 ? counted(copies.length, "state") : "scoped variables";
  const plan: Plan = {
    name: `${verb} ${what}`,
    edit: together([
      ...pins(machine, container, new Set()),
      { edit: "paste", path: container, selection: { ...selection, states }, ids: [...ids] },
      ...firstStart(machine, container, target, ids[0]),
      ...(placement && waypoints ? bends(container, target, waypoints, placement) : []),
    ]),
    select: ids.map((id) => ({ kind: "state", path: childPath(container, id) })),
  };
  return plan;
}

/** The first state in an empty hierarchy becomes its start. */
function firstStart(
  machine: Machine,
  path: string,
  target: StateDocument,
  id: string | undefined,
): Edit[] {
  const isEmpty = machine.children(path).length === 0 && !startOf(target);
  if (id === undefined || target.kind !== "hierarchy" || !isEmpty) return [];
  return [{ edit: "set_start", path, to: { state: id } }];
}

/** Offset of the copies. */
interface Placement {
  readonly from: Point;
  readonly to: Point;
  readonly factor: number;
}

/** The place of copies, as large as fits; null if nothing of them is drawn. */
function placementFor(
  machine: Machine,
  container: string,
  copies: readonly StateDocument[][],
  pastePlace: PastePlace,
): Placement | null {
  const bounds = boundsOf(
    copies.flatMap(([first], index) => (first ? drawnBox(first, index) : [])),
  );
  if (!bounds) return null;
  const size = sizeIn(machine, container);
  const factor = Math.min(
    1,
    (0.8 * size.width) / bounds.width,
    (0.8 * size.height) / bounds.height,
  );
  const whole = { width: bounds.width * factor, height: bounds.height * factor };
  const taken = [...childBoxes(machine, container).values()];
  const first = { ...bounds, ...whole };
  const { middle } = pastePlace;
  const corner = middle && { x: middle.x - whole.width / 2, y: middle.y - whole.height / 2 };
  const at = corner ?? pastePlace.corner ?? besides(inside(first, size), first, taken);
  return { from: bounds, to: inside({ ...whole, ...at }, size, lineRoom(size)), factor };
}

function moved({ x, y }: Point, { from, to, factor }: Placement): Point {
  return { x: to.x + (x - from.x) * factor, y: to.y + (y - from.y) * factor };
}

function into(
  states: readonly StateDocument[],
  index: number,
  placement: Placement,
): StateDocument[] {
  const [first] = states;
  if (!first) return [];
  const box = drawnBox(first, index);
  const size = { width: box.width * placement.factor, height: box.height * placement.factor };
  return drawnInto(states, { ...moved(box, placement), ...size });
}

/** Waypoints of what a paste connects: it numbers connections from the last one on, in their order. */
function bends(
  path: string,
  target: StateDocument,
  waypoints: CopiedWaypoints,
  placement: Placement,
): Edit[] {
  const lists = [
    ["transition", target.kind === "hierarchy" ? waypoints.transitions : [], transitionsOf(target)],
    ["data_flow", waypoints.data_flows, dataFlowsOf(target)],
  ] as const;
  return lists.flatMap(([kind, lines, taken]) => {
    const next = taken.reduce((last, { id }) => Math.max(last, id), 0) + 1;
    return lines.flatMap((points, index) => {
      const element =
        kind === "transition" ? { transition: next + index } : { data_flow: next + index };
      const waypoints = points.map((point) => moved(point, placement));
      return waypoints.length > 0 ? [waypointsEdit(path, element, waypoints)] : [];
    });
  });
}

/** Copies states into another container, their left top corner at a point of it. */
export function duplicateInto(
  machine: Machine,
  paths: readonly string[],
  container: string,
  corner: Point,
): Planned {
  const selection = copiesOf(machine, paths);
  if (isRefused(selection)) return selection;
  const copied = { selection, ways: undefined };
  const plan = pasted(machine, container, copied, { corner }, "Duplicate");
  return isRefused(plan) ? plan : { ...plan, name: `Duplicate ${statesInWords(machine, paths)}` };
}

function copiesOf(machine: Machine, paths: readonly string[]): Selection | Refused {
  return copySelection(
    machine,
    paths.map((path) => ({ kind: "state", path })),
  );
}

/** Copies states beside themselves. */
export function duplicate(machine: Machine, paths: readonly string[], by: Point): Planned {
  const container = commonContainer(machine, paths);
  if (typeof container !== "string") return container;
  const selection = copiesOf(machine, paths);
  if (isRefused(selection)) return selection;
  const bounds = boundsOf(paths.map((path) => boxIn(machine, path)));
  const corner = bounds ? { x: bounds.x + by.x, y: bounds.y + by.y } : undefined;
  const waypoints = copiedWaypoints(machine, container, selection);
  const plan = pasted(machine, container, { selection, ways: waypoints }, { corner }, "Duplicate");
  return isRefused(plan) ? plan : { ...plan, name: `Duplicate ${statesInWords(machine, paths)}` };
}
