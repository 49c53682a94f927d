/** Ends of connections as elements, and connections in words: `Scan.ok → Search`. */

import { type ElementRef, keyOf } from "./element.ts";
import type { DataFlowDocument, StateDocument, TransitionDocument } from "./generated/protocol.ts";
import {
  dataFlowsOf,
  type Machine,
  outcomesOf,
  type PortKind,
  portsOf,
  transitionsOf,
} from "./machine.ts";
import { childPath, idOf, parentOf } from "./path.ts";

export interface ConnectionEnds {
  readonly from: ElementRef;
  readonly to: ElementRef;
}

export interface DataPort {
  readonly kind: PortKind;
  readonly path: string;
  readonly id: number;
}

export interface ConnectionRef {
  readonly kind: "transition" | "data_flow";
  readonly path: string;
  readonly id: number;
}

export function isPort(element: ElementRef): element is ElementRef & DataPort {
  return (
    element.kind === "input" || element.kind === "output" || element.kind === "scoped_variable"
  );
}

export function isConnection(element: ElementRef): element is ElementRef & ConnectionRef {
  return element.kind === "transition" || element.kind === "data_flow";
}

/** Both ends of a transition of the container. */
export function transitionEnds(container: string, transition: TransitionDocument): ConnectionEnds {
  const { from_state, from_outcome, to_state, to_outcome } = transition;
  return {
    from:
      from_state == null
        ? { kind: "income", path: container }
        : { kind: "outcome", path: childPath(container, from_state), id: from_outcome ?? 0 },
    to:
      to_outcome == null
        ? { kind: "income", path: childPath(container, to_state ?? "") }
        : { kind: "outcome", path: container, id: to_outcome },
  };
}

/** Both ends of a data flow of the container; null if a port is missing. */
export function flowEnds(
  machine: Machine,
  container: string,
  flow: DataFlowDocument,
): ConnectionEnds | null {
  const from = portOf(machine, stateOfEnd(container, flow.from_state), flow.from_port);
  const to = portOf(machine, stateOfEnd(container, flow.to_state), flow.to_port);
  return from && to && { from, to };
}

function stateOfEnd(container: string, id: string): string {
  return id === idOf(container) ? container : childPath(container, id);
}

const LISTS: readonly PortKind[] = ["input", "output", "scoped_variable"];

/** Port of a state by its id, which is unique among the state's ports. */
function portOf(machine: Machine, path: string, id: number): DataPort | null {
  const state = machine.state(path);
  const kind = state && LISTS.find((list) => portsOf(state, list).some((port) => port.id === id));
  return kind ? { kind, path, id } : null;
}

/** Both ends of a connection; null if it, or one of them, is missing. */
export function endsOf(machine: Machine, connection: ConnectionRef): ConnectionEnds | null {
  const state = machine.state(connection.path);
  if (!state) return null;
  if (connection.kind === "transition") {
    const found = transitionsOf(state).find(({ id }) => id === connection.id);
    return found ? transitionEnds(connection.path, found) : null;
  }
  const found = dataFlowsOf(state).find(({ id }) => id === connection.id);
  return found ? flowEnds(machine, connection.path, found) : null;
}

/** Name of an outcome, port or state; "start" for an income. */
export function nameOf(machine: Machine, element: ElementRef): string {
  const state = machine.state(element.path);
  if (!state) return element.path;
  if (element.kind === "state") return state.name;
  if (element.kind === "income") return "start";
  if (isConnection(element)) return connectionInWords(machine, element);
  const list = isPort(element) ? portsOf(state, element.kind) : outcomesOf(state);
  const words = element.kind === "scoped_variable" ? "scoped variable" : element.kind;
  return list.find(({ id }) => id === element.id)?.name ?? `${words} ${element.id}`;
}

/** One end of a connection of the container: `Scan.ok`, `Search`, `start`. */
export function endInWords(machine: Machine, container: string, end: ElementRef): string {
  const state = machine.state(end.path)?.name ?? idOf(end.path);
  if (end.kind === "income") return end.path === container ? "start" : state;
  return `${state}.${nameOf(machine, end)}`;
}

/** `Scan.ok → Search`. */
export function connectionInWords(machine: Machine, connection: ConnectionRef): string {
  const ends = endsOf(machine, connection);
  if (!ends)
    return `${connection.kind === "transition" ? "transition" : "data flow"} ${connection.id}`;
  const [from, to] = [ends.from, ends.to].map((end) => endInWords(machine, connection.path, end));
  return `${from} → ${to}`;
}

/** A connection with its ends. */
export interface Connection {
  readonly element: ConnectionRef;
  readonly ends: ConnectionEnds;
}

/** Connections of a state: those in the container around it that touch it, and inner ones that begin or end at it. */
export function connectionsOf(
  machine: Machine,
  path: string,
  kind: ConnectionRef["kind"],
): readonly Connection[] {
  const around = parentOf(path);
  const places = around === null ? [path] : [around, path];
  return places.flatMap((container) =>
    connectionsIn(machine, container, kind).filter(
      ({ ends }) => ends.from.path === path || ends.to.path === path,
    ),
  );
}

/** All connections of a container. */
export function connectionsIn(
  machine: Machine,
  container: string,
  kind: ConnectionRef["kind"],
): readonly Connection[] {
  const state = machine.state(container);
  if (!state) return [];
  const ids = kind === "transition" ? transitionsOf(state) : dataFlowsOf(state);
  return ids.flatMap(({ id }) => {
    const element = { kind, path: container, id };
    const ends = endsOf(machine, element);
    return ends ? [{ element, ends }] : [];
  });
}

/** Elements of the container at which a transition or data flow can begin or end. Combinations of two ends are not checked. */
export function endsIn(
  machine: Machine,
  container: string,
  kind: ConnectionRef["kind"],
  end: keyof ConnectionEnds,
): readonly ElementRef[] {
  const state = machine.state(container);
  if (!state) return [];
  const children = machine.children(container).flatMap((path) => {
    const child = machine.state(path);
    return child ? [{ path, child }] : [];
  });
  if (kind === "transition")
    return end === "from"
      ? [
          { kind: "income", path: container },
          ...children.flatMap((each) => outcomes(each.child, each.path)),
        ]
      : [
          ...children.map(({ path }) => ({ kind: "income", path }) as const),
          ...outcomes(state, container),
        ];
  const own: readonly PortKind[] =
    end === "from" ? ["input", "scoped_variable"] : ["output", "scoped_variable"];
  const theirs: PortKind = end === "from" ? "output" : "input";
  return [
    ...own.flatMap((list) => ports(state, container, list)),
    ...children.flatMap((each) => ports(each.child, each.path, theirs)),
  ];
}

function outcomes(state: StateDocument, path: string): readonly ElementRef[] {
  return outcomesOf(state).map(({ id }) => ({ kind: "outcome", path, id }) as const);
}

function ports(state: StateDocument, path: string, kind: PortKind): readonly DataPort[] {
  return portsOf(state, kind).map(({ id }) => ({ kind, path, id }));
}

/** A port that is reached along data flows. */
export interface Hop {
  readonly port: DataPort;
  /** Number of data flows on the route. */
  readonly steps: number;
  /** Data flow that leads there; null where the value only crosses the border of a library. */
  readonly flow: ConnectionRef | null;
}

/** Every port that values of this one reach or, backwards, come from, across levels and libraries. Along each route the nearest
 * comes first. */
export function chain(
  machine: Machine,
  port: DataPort,
  direction: "forwards" | "backwards",
): readonly Hop[] {
  const seen = new Set([keyOf(port)]);
  const found: Hop[] = [];
  const walk = (from: DataPort, steps: number) => {
    for (const { port: next, flow } of neighbours(machine, from, direction)) {
      if (seen.has(keyOf(next))) continue;
      seen.add(keyOf(next));
      const hop = { port: next, steps: steps + (flow ? 1 : 0), flow };
      found.push(hop);
      walk(next, hop.steps);
    }
  };
  walk(port, 0);
  return found;
}

function neighbours(
  machine: Machine,
  port: DataPort,
  direction: "forwards" | "backwards",
): readonly Pick<Hop, "port" | "flow">[] {
  const [near, far]: readonly [keyof ConnectionEnds, keyof ConnectionEnds] =
    direction === "forwards" ? ["from", "to"] : ["to", "from"];
  const key = keyOf(port);
  const flows = connectionsOf(machine, port.path, "data_flow").flatMap(({ element, ends }) => {
    const other = ends[far];
    return keyOf(ends[near]) === key && isPort(other) ? [{ port: other, flow: element }] : [];
  });
  return [...flows, ...acrossLibrary(machine, port, direction)];
}

/** Crosses the border of a library: a library state and the root of its content have equal ports. */
function acrossLibrary(
  machine: Machine,
  { kind, path, id }: DataPort,
  direction: "forwards" | "backwards",
): readonly Pick<Hop, "port" | "flow">[] {
  const inwards = (kind === "input") === (direction === "forwards");
  if (kind === "scoped_variable") return [];
  const around = parentOf(path);
  const other = inwards ? machine.children(path)[0] : around;
  const library = inwards ? path : around;
  if (other == null || library === null || machine.state(library)?.kind !== "library") return [];
  const port = portOf(machine, other, id);
  return port && port.kind === kind ? [{ port, flow: null }] : [];
}
