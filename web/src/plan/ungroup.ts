/** Ungrouping: the children of a container keep their places on the screen. */

import type {
  Edit,
  Goal,
  OutcomeOf,
  StateDocument,
  TransitionDocument,
} from "../model/generated/protocol.ts";
import type { Point } from "../model/geometry.ts";
import { readLayout } from "../model/layout_reader.ts";
import { type Machine, startOf, transitionsOf } from "../model/machine.ts";
import { childPath, idOf, parentOf } from "../model/path.ts";
import { boxIn, pins, shiftedChildren, waypointsEdit } from "./boxes.ts";
import { containerAt, movableFrom } from "./legal.ts";
import { newId } from "./newcomers.ts";
import { passingRefused } from "./passing.ts";
import { isRefused, type Planned, together } from "./plan.ts";
import { isStoredRightAngled, storedWay } from "./right_angles.ts";
import { kindRefused } from "./transitions.ts";

/** Replaces a container by its children, at its position. */
export function ungroup(machine: Machine, path: string): Planned {
  const parent = movableFrom(machine, path);
  if (typeof parent !== "string") return parent;
  const state = containerAt(machine, path);
  if (isRefused(state)) return state;
  const around = containerAt(machine, parent);
  if (isRefused(around)) return around;
  const children = machine
    .children(path)
    .filter((child) => machine.state(child)?.kind !== "decider");
  const ids = freedIds(machine, parent, path, children);
  const lines = freedLines(around, path, state, ids.byOld);
  for (const line of lines) {
    const bad = kindRefused(around, line);
    if (bad) return bad;
  }
  const bad = passingRefused(machine, path);
  if (bad) return bad;
  const { x, y } = boxIn(machine, path);
  const edits: Edit[] = [
    ...pins(machine, parent, new Set([path])),
    ...shiftedChildren(machine, children, { x, y }),
    { edit: "ungroup", path: parent, state: idOf(path), fresh: ids.fresh },
    ...freedWaypoints(machine, path, lines, { x, y }),
  ];
  return {
    name: `Ungroup ${state.name}`,
    edit: together(edits),
    select: [...ids.byOld.values()].map((id) => ({ kind: "state", path: childPath(parent, id) })),
  };
}

interface Freed {
  readonly byOld: ReadonlyMap<string, string>;
  /** Only those that are needed, in the order of need. */
  readonly fresh: string[];
}

/** Ids of the children in the container around: their own unless those are taken there. */
function freedIds(
  machine: Machine,
  parent: string,
  path: string,
  children: readonly string[],
): Freed {
  const siblings = machine
    .children(parent)
    .filter((other) => other !== path)
    .map(idOf);
  const taken = new Set([...siblings, idOf(parent)]);
  const own = new Set(children.map(idOf));
  const byOld = new Map<string, string>();
  const fresh: string[] = [];
  for (const child of children) {
    const id = idOf(child);
    const free = taken.has(id) ? newId(machine, parent, [...own, ...fresh]) : id;
    if (free !== id) fresh.push(free);
    taken.add(free);
    byOld.set(id, free);
  }
  return { byOld, fresh };
}

/** A line inside of a container as it is without the container. */
interface FreedLine {
  readonly line: TransitionDocument;
  readonly from: OutcomeOf;
  readonly to: Goal;
}

/** The lines that stay, in the order in which they get ids. */
function freedLines(
  around: StateDocument,
  path: string,
  state: StateDocument,
  ids: ReadonlyMap<string, string>,
): readonly FreedLine[] {
  return transitionsOf(state).flatMap((transition) => {
    const from = ids.get(transition.from_state ?? "");
    const to = freedGoal(transition, around, path, state, ids);
    if (from === undefined || !to) return [];
    const outcome = transition.from_outcome ?? 0;
    return [{ line: transition, from: { state: from, outcome }, to }];
  });
}

/** Moves waypoints between the children. Lines with right angles from or to the container are routed again. */
function freedWaypoints(
  machine: Machine,
  path: string,
  lines: readonly FreedLine[],
  by: Point,
): Edit[] {
  const parent = parentOf(path) ?? "";
  const around = machine.state(parent);
  if (!around) return [];
  const { waypoints } = readLayout(around);
  const next = Math.max(0, ...transitionsOf(around).map(({ id }) => id)) + 1;
  const edits = lines.flatMap(({ line }, index) => {
    const element = { transition: next + index };
    const isCut = line.to_outcome != null && isStoredRightAngled(machine, path, line);
    const points = isCut ? [] : storedWay(machine, path, line);
    const isNone = points.length === 0 && !waypoints.get(`transition${next + index}`)?.length;
    const moved = points.map((point) => ({ x: point.x + by.x, y: point.y + by.y }));
    return isNone ? [] : [waypointsEdit(parent, element, moved)];
  });
  const entries = transitionsOf(around).filter(
    (line) =>
      line.to_state === idOf(path) &&
      line.from_state !== idOf(path) &&
      isStoredRightAngled(machine, parent, line),
  );
  return [...edits, ...entries.map(({ id }) => waypointsEdit(parent, { transition: id }, []))];
}

/** End of an inner transition after the container is removed; null without one. */
function freedGoal(
  { to_state, to_outcome }: TransitionDocument,
  around: StateDocument,
  path: string,
  state: StateDocument,
  ids: ReadonlyMap<string, string>,
): Goal | null {
  const inner = (id: string | null | undefined): Goal | null => {
    const free = ids.get(id ?? "");
    return free === undefined ? null : { state: free };
  };
  if (to_outcome == null) return inner(to_state);
  const behind = transitionsOf(around).find(
    ({ from_state, from_outcome }) => from_state === idOf(path) && from_outcome === to_outcome,
  );
  if (!behind) return null;
  if (behind.to_outcome != null) return { outcome: behind.to_outcome };
  if (behind.to_state !== idOf(path)) return { state: behind.to_state ?? "" };
  const start = startOf(state);
  return start?.to_outcome == null ? inner(start?.to_state) : null;
}
