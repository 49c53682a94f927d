/** Lines at right angles: whether a way has them, and how it keeps them when its ends move. */

import type { Edit, StateDocument, TransitionDocument } from "../model/generated/protocol.ts";
import type { Box, Point } from "../model/geometry.ts";
import { changed } from "../model/layout.ts";
import { portPlaces, readLayout } from "../model/layout_reader.ts";
import { type Machine, transitionsOf } from "../model/machine.ts";
import { childPath } from "../model/path.ts";
import { boxIn, waypointsEdit } from "./boxes.ts";

/** A piece that deviates less than this part of its length counts as upright or level. */
const STRAIGHT = 0.02;
/** Part of a coordinate that is lost by rounding. */
const NOISE = 1e-6;

/** True if all pieces of a way are upright or level within the drawing's accuracy. */
export function isRightAngled(points: readonly Point[]): boolean {
  return points.every((to, index) => isStraight(points[index - 1] ?? to, to));
}

/** The same but for what is only arithmetic. */
export function isExactlyRightAngled(points: readonly Point[]): boolean {
  return points.every((to, index) => isStraight(points[index - 1] ?? to, to, 0));
}

function isStraight(from: Point, to: Point, part = STRAIGHT): boolean {
  const [wide, high] = [Math.abs(from.x - to.x), Math.abs(from.y - to.y)];
  const noise = NOISE * Math.max(Math.abs(to.x), Math.abs(to.y));
  return Math.min(wide, high) <= Math.max(noise, part * Math.max(wide, high));
}

/** Positions of states and their ports. */
interface Drawing {
  readonly state: (path: string) => StateDocument | undefined;
  readonly box: (path: string) => Box;
}

interface StoredEnds {
  readonly start: Point | null;
  readonly goal: Point | null;
}

/** Ends of a transition in the coordinates of the container; null without a position. */
export function lineEnds(
  machine: Machine,
  container: string,
  line: TransitionDocument,
): StoredEnds {
  return endsIn(drawingOf(machine), container, line);
}

function drawingOf(machine: Machine): Drawing {
  return { state: (path) => machine.state(path), box: (path) => boxIn(machine, path) };
}

function endsIn(drawing: Drawing, container: string, line: TransitionDocument): StoredEnds {
  const { from_state, from_outcome, to_state, to_outcome } = line;
  return {
    start: portIn(drawing, container, from_state ?? null, from_outcome ?? null),
    goal: portIn(drawing, container, to_outcome == null ? to_state : null, to_outcome ?? null),
  };
}

/** The port of a child, or without an id of the container; without an outcome it is the income. */
function portIn(
  drawing: Drawing,
  container: string,
  id: string | null | undefined,
  outcome: number | null,
): Point | null {
  const path = id == null ? container : childPath(container, id);
  const state = drawing.state(path);
  if (!state) return null;
  const box = drawing.box(path);
  const isWanted = (port: { readonly kind: string; readonly id: number }) =>
    outcome === null ? port.kind === "income" : port.kind === "outcome" && port.id === outcome;
  const at = portPlaces(state, path, box).find(isWanted)?.at;
  if (!at) return null;
  return id == null ? at : { x: box.x + at.x, y: box.y + at.y };
}

/** Edits that keep lines at right angles whose ends the other edits move: bends between ends that move alike go along, the leg at an
 * end that moves alone stays upright or level, and a line that would turn back looks for another way. Lines that were drawn
 * freely stay. */
export function keptRightAngles(
  machine: Machine,
  containers: readonly string[],
  edits: readonly Edit[],
): Edit[] {
  const then = new DrawingAfter(machine, edits);
  return containers.flatMap((container) => {
    const state = machine.state(container);
    const next = then.state(container);
    if (!state || !next) return [];
    const [before, after] = [readLayout(state).waypoints, readLayout(next).waypoints];
    return transitionsOf(state).flatMap((line) => {
      const key = `transition${line.id}`;
      const [points, shown] = [before.get(key) ?? [], after.get(key) ?? []];
      if (points.length === 0 || !then.touches(container, line)) return [];
      const ends = lineEnds(machine, container, line);
      const kept = keptBends(points, shown, ends, endsIn(then, container, line));
      return kept ? [waypointsEdit(container, { transition: line.id }, kept)] : [];
    });
  });
}

/** A machine as edits of its drawing leave it. */
class DrawingAfter implements Drawing {
  readonly #machine: Machine;
  readonly #states = new Map<string, StateDocument>();

  constructor(machine: Machine, edits: readonly Edit[]) {
    this.#machine = machine;
    for (const edit of edits) this.#apply(edit);
  }

  #apply(edit: Edit): void {
    if (edit.edit === "batch") {
      for (const each of edit.edits) this.#apply(each);
      return;
    }
    if (edit.edit !== "set_layout" && edit.edit !== "set_position" && edit.edit !== "set_size")
      return;
    const state = this.state(edit.path);
    if (!state) return;
    const layout = this.#layoutAfter(state, edit) ?? null;
    this.#states.set(edit.path, { ...state, layout });
  }

  #layoutAfter(
    state: StateDocument,
    edit: Extract<Edit, { edit: "set_layout" | "set_position" | "set_size" }>,
  ): StateDocument["layout"] {
    if (edit.edit === "set_layout") return edit.layout;
    const box = this.box(edit.path);
    if (edit.edit === "set_size") {
      const [width, height] = edit.size;
      return edit.element === "state"
        ? changed(state.layout, { position: box, size: { width, height } })
        : state.layout;
    }
    const at = { x: edit.position[0], y: edit.position[1] };
    if (edit.element === "state") return changed(state.layout, { position: at, size: box });
    const key = portKey(edit.element);
    return key === null ? state.layout : changed(state.layout, { ports: new Map([[key, at]]) });
  }

  state(path: string): StateDocument | undefined {
    return this.#states.get(path) ?? this.#machine.state(path);
  }

  box(path: string): Box {
    const before = boxIn(this.#machine, path);
    const state = this.#states.get(path);
    if (!state) return before;
    const { position, size } = readLayout(state);
    return { ...before, ...position, ...size };
  }

  /** True if an end of a line may move. */
  touches(container: string, { from_state, to_state }: TransitionDocument): boolean {
    const isTouched = (id: string | null | undefined) =>
      id != null && this.#states.has(childPath(container, id));
    return this.#states.has(container) || isTouched(from_state) || isTouched(to_state);
  }
}

/** Name of a port in the layout of its state; null for other parts. */
function portKey(element: Extract<Edit, { edit: "set_position" }>["element"]): string | null {
  if (element === "income") return "income";
  return typeof element === "object" && "outcome" in element ? `outcome${element.outcome}` : null;
}

/** The bends of a line whose ends move; null if they stay as they are shown. */
function keptBends(
  points: readonly Point[],
  shown: readonly Point[],
  before: StoredEnds,
  after: StoredEnds,
): readonly Point[] | null {
  const [atStart, atGoal] = [way(before.start, after.start), way(before.goal, after.goal)];
  const kept = isSame(atStart, atGoal)
    ? points.map((point) => plus(point, atStart))
    : bentBetween(points, before, after);
  const stays =
    kept?.length === shown.length && kept.every((at, index) => isSame(at, shown[index]));
  return stays ? null : kept;
}

function bentBetween(
  points: readonly Point[],
  before: StoredEnds,
  after: StoredEnds,
): readonly Point[] | null {
  const first = bentAlong(points, before.start, way(before.start, after.start), true);
  const bent = first && bentAlong(first, before.goal, way(before.goal, after.goal), false);
  if (!isRightAngled(whole(before, points))) return bent;
  return bent && isRightAngled(whole(after, bent)) ? bent : [];
}

function whole({ start, goal }: StoredEnds, points: readonly Point[]): readonly Point[] {
  return [...(start ? [start] : []), ...points, ...(goal ? [goal] : [])];
}

function way(from: Point | null, to: Point | null): Point {
  return from && to ? { x: to.x - from.x, y: to.y - from.y } : { x: 0, y: 0 };
}

function plus(one: Point, other: Point): Point {
  return { x: one.x + other.x, y: one.y + other.y };
}

function isSame(one: Point, other: Point | undefined): boolean {
  if (!other) return false;
  const reach = 1e-9 * Math.max(1, Math.abs(one.x), Math.abs(one.y));
  return Math.abs(one.x - other.x) <= reach && Math.abs(one.y - other.y) <= reach;
}

/** Bends of a line of which one end moves: a straight leg there stays upright or level, and the bends go if it would lead back.
 * Null: a slanted leg, which was put there freely. */
function bentAlong(
  points: readonly Point[],
  end: Point | null,
  by: Point,
  isFrom: boolean,
): readonly Point[] | null {
  const at = isFrom ? 0 : points.length - 1;
  const bend = points[at];
  if (!end || !bend || (by.x === 0 && by.y === 0)) return points;
  if (!isStraight(end, bend)) return null;
  const leg = { x: bend.x - end.x, y: bend.y - end.y };
  const isLevel = Math.abs(leg.y) <= Math.abs(leg.x);
  const [before, after] = isLevel ? [leg.x, leg.x - by.x] : [leg.y, leg.y - by.y];
  if (before * after <= 0) return [];
  const moved = isLevel ? { x: bend.x, y: bend.y + by.y } : { x: bend.x + by.x, y: bend.y };
  return points.with(at, moved);
}

/** True if a transition has a stored way with right angles. */
export function isStoredRightAngled(
  machine: Machine,
  container: string,
  line: TransitionDocument,
): boolean {
  const points = storedWay(machine, container, line);
  return points.length > 0 && isRightAngled(whole(lineEnds(machine, container, line), points));
}

/** Waypoints of a transition. */
export function storedWay(
  machine: Machine,
  container: string,
  { id }: TransitionDocument,
): readonly Point[] {
  const state = machine.state(container);
  return state ? (readLayout(state).waypoints.get(`transition${id}`) ?? []) : [];
}

/** True if the stored way of a transition crosses a box. */
export function leadsThrough(
  machine: Machine,
  container: string,
  line: TransitionDocument,
  { x, y, width, height }: Box,
): boolean {
  const points = whole(lineEnds(machine, container, line), storedWay(machine, container, line));
  return points.some((from, index) => {
    const to = points[index + 1] ?? from;
    return (
      Math.min(from.x, to.x) < x + width &&
      Math.max(from.x, to.x) > x &&
      Math.min(from.y, to.y) < y + height &&
      Math.max(from.y, to.y) > y
    );
  });
}
