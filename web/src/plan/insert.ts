/** Putting a state into a transition: the transition leads to the state, and a new one from there to where it led. */

import type { ElementRef } from "../model/element.ts";
import type { Edit, Goal, StateDocument, TransitionDocument } from "../model/generated/protocol.ts";
import { centre, distance, type Point } from "../model/geometry.ts";
import { waypointsOf } from "../model/layout_reader.ts";
import { type Machine, outcomesOf, transitionsOf } from "../model/machine.ts";
import { freshNumber } from "../model/names.ts";
import { childPath, idOf, parentOf } from "../model/path.ts";
import { childBoxes, pins, sizeIn, waypointsEdit } from "./boxes.ts";
import { containerAt, stateAt } from "./legal.ts";
import { type LibraryToInsert, type NewKind, newBox, newLibrary, newState } from "./newcomers.ts";
import { isRefused, type Planned, type Refused, refused, together } from "./plan.ts";
import { freeOutcome } from "./transitions.ts";

/** The inserted state: an existing one, a new one of a kind, or a library state. */
type Inserted =
  | string
  | { readonly kind: NewKind; readonly name?: string }
  | { readonly library: LibraryToInsert; readonly root: StateDocument };

/** Inserts a state into a transition: an existing one, or a new one with its centre at the point. */
export function insertState(
  machine: Machine,
  element: ElementRef,
  state: Inserted,
  at: Point,
): Planned {
  const container = containerAt(machine, element.path);
  if (isRefused(container)) return container;
  const found =
    element.kind === "transition"
      ? transitionsOf(container).find(({ id }) => id === element.id)
      : undefined;
  if (!found) return refused("This transition no longer exists: someone may have removed it.");
  const goal = goalOf(found);
  const comer = typeof state === "string" ? standing(machine, found, element.path, state) : null;
  if (comer && isRefused(comer)) return comer;
  const added = typeof state === "string" ? null : newcomer(machine, element.path, state, at);
  const outcome = comer ? comer.outcome : added && wayOut(added);
  if (outcome === null) {
    return refused(`${added?.name} has no outcome to continue from: put it beside the transition.`);
  }
  const id = comer?.id ?? added?.path ?? "";
  const transition = freshNumber(transitionsOf(container));
  const path = element.path;
  const from = { state: id, outcome };
  const edits: Edit[] = [
    ...(added ? addition(machine, path, added) : (comer?.edits ?? [])),
    { edit: "set_transition_target", path, transition: found.id, to: { state: id } },
    { edit: "add_transition", path, transition, from, to: goal },
    ...splitWaypoints(path, container, found.id, transition, at),
  ];
  const select: ElementRef[] = [{ kind: "state", path: childPath(path, id) }];
  return (
    insertRefused(container) ?? {
      name: "Insert state into transition",
      edit: together(edits),
      select,
    }
  );
}

/** A point of a transition for a state between its ends. */
export function middleOf(machine: Machine, element: ElementRef): Point {
  const container = machine.state(element.path);
  const found =
    element.kind === "transition" && container
      ? transitionsOf(container).find(({ id }) => id === element.id)
      : undefined;
  const size = sizeIn(machine, element.path);
  if (!container || !found) return { x: size.width / 2, y: size.height / 2 };
  const points = waypointsOf(container, "transition", found.id);
  const bend = points[Math.floor(points.length / 2)];
  if (bend) return bend;
  const boxes = childBoxes(machine, element.path);
  const at = (id: string | null | undefined, side: number) => {
    const box = id == null ? undefined : boxes.get(childPath(element.path, id));
    return box ? centre(box) : { x: side, y: size.height / 2 };
  };
  const from = at(found.from_state, 0);
  const to = at(found.to_outcome == null ? found.to_state : null, size.width);
  return { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 };
}

function goalOf({ to_state, to_outcome }: TransitionDocument): Goal {
  return to_outcome == null ? { state: to_state ?? "" } : { outcome: to_outcome };
}

function insertRefused(container: StateDocument): Refused | null {
  return container.kind === "hierarchy"
    ? null
    : refused(
        `${container.name} runs all its states at once. Nothing can be inserted between two of them.`,
      );
}

function newcomer(
  machine: Machine,
  container: string,
  comes: Exclude<Inserted, string>,
  at: Point,
): StateDocument {
  if ("library" in comes) return newLibrary(machine, container, comes.library, comes.root, at);
  return newState(machine, container, comes.kind, newBox(machine, container, at), comes.name);
}

/** The first outcome of a new state that is not one of failure. */
function wayOut(state: StateDocument): number | null {
  return outcomesOf(state).find(({ id }) => id >= 0)?.id ?? null;
}

function addition(machine: Machine, path: string, state: StateDocument): Edit[] {
  const edits = pins(machine, path, new Set());
  return [...edits, { edit: "add_state", path, states: [state] }];
}

interface Comer {
  readonly id: string;
  readonly outcome: number;
  readonly edits: Edit[];
}

/** A sibling with an outcome that leads nowhere yet, or to which one can be given. */
function standing(
  machine: Machine,
  transition: TransitionDocument,
  container: string,
  path: string,
): Comer | Refused {
  const state = stateAt(machine, path);
  if (isRefused(state)) return state;
  if (parentOf(path) !== container) {
    return refused(`Move ${state.name} into ${machine.state(container)?.name} first.`);
  }
  const id = idOf(path);
  if (transition.from_state === id || goalIs(transition, id)) {
    return refused(`The transition already leads from or to ${state.name}.`);
  }
  const free = freeOutcome(machine, path);
  if (free !== null) return { id, outcome: free, edits: [] };
  if (state.kind === "library" || outcomesOf(state).some((outcome) => outcome.id >= 0)) {
    return refused(`All outcomes of ${state.name} are connected: add one, or delete a transition.`);
  }
  return { id, outcome: 0, edits: [{ edit: "add_outcome", path, outcome: 0, name: "success" }] };
}

function goalIs({ to_state, to_outcome }: TransitionDocument, id: string): boolean {
  return to_outcome == null && to_state === id;
}

/** Waypoints before the new state stay with the first transition, those behind it go to the second. */
function splitWaypoints(
  path: string,
  container: StateDocument,
  first: number,
  second: number,
  at: Point,
): Edit[] {
  const points = waypointsOf(container, "transition", first);
  if (points.length === 0) return [];
  const nearest = points.reduce((best, point, index) => {
    const known = points[best];
    return known && distance(known, at) <= distance(point, at) ? best : index;
  }, 0);
  return [
    waypointsEdit(path, { transition: first }, points.slice(0, nearest)),
    waypointsEdit(path, { transition: second }, points.slice(nearest + 1)),
  ];
}
