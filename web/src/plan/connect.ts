/** Connecting outcomes with states, and ports with ports: on one level, over several, and anew. */

import type { ElementRef } from "../model/element.ts";
import { type ConnectionEnds, type DataPort, endsOf, isConnection, isPort } from "../model/ends.ts";
import type {
  DataFlowDocument,
  Edit,
  Goal,
  StateDocument,
  TransitionDocument,
} from "../model/generated/protocol.ts";
import { centre, distance } from "../model/geometry.ts";
import { dataFlowsOf, type Machine, outcomesOf, startOf, transitionsOf } from "../model/machine.ts";
import { freshName, freshNumber } from "../model/names.ts";
import { idOf, isWithin, parentOf } from "../model/path.ts";
import { childBoxes, waypointsEdit } from "./boxes.ts";
import { courseBetween, fittingPort, flowEdits, portAt, portEdit } from "./flows.ts";
import { containerAt, interfaceAt, movableFrom, stateAt } from "./legal.ts";
import { isRefused, type Plan, type Planned, type Refused, refused, together } from "./plan.ts";
import { isStoredRightAngled } from "./right_angles.ts";
import {
  beginning,
  climb,
  freeOutcome,
  lineBetween,
  lineEdit,
  lineRefused,
} from "./transitions.ts";

export type ConnectionEnd = "from" | "to";

interface Ignored {
  readonly path: string;
  readonly id: number;
}

/** True if `connect` may make a connection between the two. */
export function checkConnect(machine: Machine, from: ElementRef, to: ElementRef): true | Refused {
  const edits = connection(machine, from, to);
  return isRefused(edits) ? edits : true;
}

/** Connects two elements, whichever of them was named first; what is needed between their levels is made. */
export function connect(machine: Machine, from: ElementRef, to: ElementRef): Planned {
  const edits = connection(machine, from, to);
  if (isRefused(edits)) return edits;
  return { name: isPort(from) ? "Add data flow" : "Add transition", edit: together(edits) };
}

function connection(
  machine: Machine,
  from: ElementRef,
  to: ElementRef,
  ignored?: Ignored,
): Edit[] | Refused {
  if (isPort(from) && isPort(to)) return flow(machine, from, to, ignored);
  if (isPort(from) && to.kind === "state") return toState(machine, from, to.path, ignored);
  if (isPort(to) && from.kind === "state") return toState(machine, to, from.path, ignored);
  if (isPort(from) || isPort(to)) {
    return refused(
      "Data flows connect ports, transitions connect an outcome with a state. These two cannot be connected.",
    );
  }
  return transition(machine, from, to, ignored);
}

function flow(
  machine: Machine,
  one: ElementRef & DataPort,
  other: ElementRef & DataPort,
  ignored: Ignored | undefined,
): Edit[] | Refused {
  const [first, second] = [portAt(machine, one), portAt(machine, other)];
  if (isRefused(first)) return first;
  if (isRefused(second)) return second;
  const course = courseBetween(machine, first, second);
  return isRefused(course) ? course : flowEdits(machine, course, ignored);
}

function transition(
  machine: Machine,
  one: ElementRef,
  other: ElementRef,
  ignored: Ignored | undefined,
): Edit[] | Refused {
  const backwards = lineBetween(one, other) === null && runsBackwards(one, other);
  const [from, to] = backwards ? [other, one] : [one, other];
  const source = from.kind === "state" ? outcomeOf(machine, from.path) : from;
  if (isRefused(source)) return source;
  const line = lineBetween(source, to);
  if (!line) return climb(machine, source, to, ignored);
  const own = ignored?.path === line.container ? ignored.id : undefined;
  return lineRefused(machine, line, own) ?? [lineEdit(machine, line)];
}

/** True if the line was drawn from its end: from an income to an outcome, or from the container's outcome. */
function runsBackwards(one: ElementRef, other: ElementRef): boolean {
  if (lineBetween(other, one) !== null) return true;
  if (one.kind === "state" && isWithin(one.path, other.path)) return false;
  return (one.kind === "income" || one.kind === "state") && other.kind === "outcome";
}

function outcomeOf(machine: Machine, path: string): ElementRef | Refused {
  const id = freeOutcome(machine, path);
  const name = machine.state(path)?.name;
  return id === null
    ? refused(`All outcomes of ${name} are connected: add one, or move the end of a transition.`)
    : { kind: "outcome", path, id };
}

/** Connects with a state: a port gets the port that it needs there, an outcome leads to the state. */
export function connectToState(machine: Machine, from: ElementRef, path: string): Planned {
  const state = stateAt(machine, path);
  if (isRefused(state)) return state;
  if (isPort(from)) {
    const edits = toState(machine, from, path);
    return isRefused(edits) ? edits : { name: "Add port and data flow", edit: together(edits) };
  }
  if (from.kind === "outcome" && parentOf(from.path) === path) {
    return toNewOutcome(machine, from, path);
  }
  return connect(machine, from, { kind: "state", path });
}

function toState(
  machine: Machine,
  from: ElementRef & DataPort,
  path: string,
  ignored?: Ignored,
): Edit[] | Refused {
  const other = portAt(machine, from);
  if (isRefused(other)) return other;
  const state = interfaceAt(machine, path);
  if (isRefused(state)) return state;
  const port = fittingPort(machine, other, path);
  if (isRefused(port)) return port;
  const course = courseBetween(machine, other, port);
  if (isRefused(course)) return course;
  const edits = flowEdits(machine, course, ignored);
  return isRefused(edits) ? edits : [portEdit(port), ...edits];
}

/** Leads out of the container by an outcome that is made for it. */
function toNewOutcome(
  machine: Machine,
  from: ElementRef & { readonly id: number },
  path: string,
): Planned {
  const container = interfaceAt(machine, path);
  if (isRefused(container)) return container;
  const child = machine.state(from.path);
  const source = child && outcomesOf(child).find(({ id }) => id === from.id);
  if (!source) return refused("This outcome no longer exists: someone may have removed it.");
  const names = outcomesOf(container).map((each) => each.name);
  const outcome = freshNumber(outcomesOf(container));
  const name = freshName(source.name, names);
  const line = lineBetween(from, { kind: "outcome", path, id: outcome });
  if (!line) return refused("A state leads only to outcomes of its container.");
  const bad = lineRefused(machine, line);
  if (bad) return bad;
  const edits: Edit[] = [{ edit: "add_outcome", path, outcome, name }, lineEdit(machine, line)];
  return { name: "Add outcome and transition", edit: together(edits) };
}

/** Lets one end of a connection be elsewhere; on another level the connection is made anew. */
export function reconnect(
  machine: Machine,
  connected: ElementRef,
  end: ConnectionEnd,
  target: ElementRef,
): Planned {
  if (!isConnection(connected)) {
    return refused("Only transitions and data flows have ends.");
  }
  const container = stateAt(machine, connected.path);
  if (isRefused(container)) return container;
  const ends = endsOf(machine, connected);
  if (!ends) return refused("This connection no longer exists: someone may have removed it.");
  const data = connected.kind === "data_flow";
  const name = data ? "Change end of data flow" : "Change end of transition";
  const now = end === "from" ? { ...ends, from: target } : { ...ends, to: target };
  const edits = data
    ? flowAnew(machine, container, connected, now)
    : transitionAnew(machine, connected, now, end);
  return isRefused(edits) ? edits : { name, edit: together(edits) };
}

/** Leads the transition that an outcome has already to another element of its level; null if there is none, or if it cannot lead
 * there. */
export function ledElsewhere(machine: Machine, from: ElementRef, to: ElementRef): Plan | null {
  const line = from.kind === "outcome" ? lineBetween(from, to) : null;
  const container = line ? machine.state(line.container) : undefined;
  const old = line?.from && container ? beginning(container, line.from) : undefined;
  if (!line || !old || leadsTo(old, line.to)) return null;
  const element = { kind: "transition", path: line.container, id: old.id } as const;
  const plan = reconnect(machine, element, "to", to);
  return isRefused(plan) ? null : plan;
}

function leadsTo({ to_state, to_outcome }: TransitionDocument, goal: Goal): boolean {
  return "outcome" in goal
    ? to_outcome === goal.outcome
    : to_outcome == null && to_state === goal.state;
}

type ConnectedElement = ElementRef & { readonly id: number };

function transitionAnew(
  machine: Machine,
  connected: ConnectedElement,
  ends: ConnectionEnds,
  end: ConnectionEnd,
): Edit[] | Refused {
  const { path, id } = connected;
  const place = { path, transition: id };
  const line = lineBetween(ends.from, ends.to);
  if (line?.container === path) {
    const bad = lineRefused(machine, line, id);
    if (bad) return bad;
    const bends = straightened(machine, connected);
    if (end === "to") return [{ edit: "set_transition_target", ...place, to: line.to }, ...bends];
    const container = machine.state(path);
    const start = line.from || !container ? undefined : startOf(container);
    // An existing start leads here from now on.
    if (start && start.id !== id)
      return [{ edit: "remove_transition", ...place }, lineEdit(machine, line)];
    return [{ edit: "set_transition_origin", ...place, from: line.from }, ...bends];
  }
  const edits = transition(machine, ends.from, ends.to, connected);
  return isRefused(edits) ? edits : [{ edit: "remove_transition", ...place }, ...edits];
}

/** A stored way with right angles is not kept to another end. */
function straightened(machine: Machine, { path, id }: ConnectedElement): Edit[] {
  const state = machine.state(path);
  const line = state && transitionsOf(state).find((each) => each.id === id);
  return line && isStoredRightAngled(machine, path, line)
    ? [waypointsEdit(path, { transition: id }, [])]
    : [];
}

function flowAnew(
  machine: Machine,
  container: StateDocument,
  connected: ConnectedElement,
  ends: ConnectionEnds,
): Edit[] | Refused {
  const { path, id } = connected;
  const edits = connection(machine, ends.from, ends.to, connected);
  if (isRefused(edits)) return edits;
  const last = edits.at(-1);
  const place = { path, data_flow: id };
  if (last?.edit !== "add_data_flow" || last.path !== path) {
    return [{ edit: "remove_data_flow", ...place }, ...edits];
  }
  const old = dataFlowsOf(container).find((flow) => flow.id === id);
  return [...edits.slice(0, -1), ...moved(old, place, last)];
}

/** The flow stays, and keeps its id, where only one end is elsewhere. */
function moved(
  old: DataFlowDocument | undefined,
  place: { readonly path: string; readonly data_flow: number },
  { from, to }: Pick<Extract<Edit, { edit: "add_data_flow" }>, "from" | "to">,
): Edit[] {
  const sameFrom = old?.from_state === from.state && old.from_port === from.port;
  const sameTo = old?.to_state === to.state && old.to_port === to.port;
  if (sameFrom) return [{ edit: "set_data_flow_target", ...place, to }];
  if (sameTo) return [{ edit: "set_data_flow_source", ...place, from }];
  return [
    { edit: "remove_data_flow", ...place },
    { edit: "add_data_flow", ...place, from, to },
  ];
}

/** A transition from the first free outcome of a state to its nearest sibling. */
export function connectToSibling(machine: Machine, path: string): Planned {
  const sibling = nearestSibling(machine, path, (other) => other);
  if (isRefused(sibling)) return sibling;
  return connect(machine, { kind: "state", path }, { kind: "income", path: sibling });
}

/** A transition to a state from the nearest sibling that has a free outcome. */
export function connectFromSibling(machine: Machine, path: string): Planned {
  const sibling = nearestSibling(machine, path, (other) =>
    freeOutcome(machine, other) === null ? null : other,
  );
  if (isRefused(sibling)) return sibling;
  return connect(machine, { kind: "state", path: sibling }, { kind: "income", path });
}

function nearestSibling(
  machine: Machine,
  path: string,
  usable: (path: string) => string | null,
): string | Refused {
  const container = movableFrom(machine, path);
  if (typeof container !== "string") return container;
  const boxes = childBoxes(machine, container);
  const own = boxes.get(path);
  const others = [...boxes.keys()].filter((other) => other !== path && usable(other) !== null);
  const away = (other: string) => {
    const box = boxes.get(other);
    return own && box ? distance(centre(own), centre(box)) : Infinity;
  };
  const nearest = others.sort((one, other) => away(one) - away(other))[0];
  return (
    nearest ?? refused(`No other state of ${machine.state(container)?.name} can be connected.`)
  );
}

/** Leads the free outcome of a state to the first outcome of its container; those that lead there already are removed. */
export function connectToParent(machine: Machine, path: string): Planned {
  const parent = movableFrom(machine, path);
  if (typeof parent !== "string") return parent;
  const container = containerAt(machine, parent);
  if (isRefused(container)) return container;
  const first = outcomesOf(container).find(({ id }) => id >= 0);
  if (!first) return refused(`${container.name} has no outcome to lead to: add one first.`);
  const there = transitionsOf(container).filter(
    ({ from_state, to_outcome }) => from_state === idOf(path) && to_outcome === first.id,
  );
  if (there.length > 0) {
    const edits = there.map(
      ({ id }): Edit => ({ edit: "remove_transition", path: parent, transition: id }),
    );
    return { name: "Remove transition", edit: together(edits) };
  }
  return connect(machine, { kind: "state", path }, { kind: "outcome", path: parent, id: first.id });
}
