/** Which data flows are legal, and those that lead over several levels through the ports between. */

import type { ElementRef } from "../model/element.ts";
import type { DataPort } from "../model/ends.ts";
import type { Edit, PortDocument, StateDocument } from "../model/generated/protocol.ts";
import {
  dataFlowsOf,
  isContainer,
  type Machine,
  type PortKind,
  portsOf,
} from "../model/machine.ts";
import { freshName, freshNumber } from "../model/names.ts";
import { commonPath, idOf, parentOf } from "../model/path.ts";
import { fits, shortType } from "../model/types.ts";
import { containerAt } from "./legal.ts";
import { isRefused, type Refused, refused } from "./plan.ts";
import { allPorts, PORT_WORDS } from "./ports.ts";

/** An existing or planned port. */
interface PortAt {
  readonly path: string;
  readonly kind: PortKind;
  readonly port: PortDocument;
}

/** A data flow that might be, from `source` to `target`. */
interface Course {
  readonly source: PortAt;
  readonly target: PortAt;
  /** The container inside which the source gives its value. */
  readonly begin: string;
  /** The container inside which the target takes it. */
  readonly end: string;
}

export function portAt(machine: Machine, element: ElementRef & DataPort): PortAt | Refused {
  const state = machine.state(element.path);
  const port = state && portsOf(state, element.kind).find(({ id }) => id === element.id);
  if (!state || !port) return refused("This port no longer exists: someone may have removed it.");
  return { path: element.path, kind: element.kind, port };
}

/** The container inside which a port gives a value; null if it gives none anywhere. */
function givesIn(machine: Machine, { path, kind }: PortAt): string | null {
  if (kind === "output") return parentOf(path);
  const state = machine.state(path);
  return state && isContainer(state) ? path : null;
}

function takesIn(machine: Machine, { path, kind }: PortAt): string | null {
  if (kind === "input") return parentOf(path);
  const state = machine.state(path);
  return state && isContainer(state) ? path : null;
}

/** Which of two ports gives the value to the other: the first if both could. */
export function courseBetween(machine: Machine, one: PortAt, other: PortAt): Course | Refused {
  const courses = [course(machine, one, other), course(machine, other, one)].filter(
    (found): found is Course => found !== null,
  );
  const level = courses.find(({ begin, end }) => begin === end);
  const across = courses.find((found) => isOpen(found));
  return level ?? across ?? wrongWay(machine, one, other);
}

function course(machine: Machine, source: PortAt, target: PortAt): Course | null {
  const [begin, end] = [givesIn(machine, source), takesIn(machine, target)];
  return begin === null || end === null ? null : { source, target, begin, end };
}

/** True if ports in between can be created: an input does not lead out of its state, nor to an output from outside. */
function isOpen({ source, target, begin, end }: Course): boolean {
  const meeting = commonPath([begin, end]);
  if (meeting === null) return false;
  return !(
    (source.kind === "input" && begin !== meeting) ||
    (target.kind === "output" && end !== meeting)
  );
}

function wrongWay(machine: Machine, one: PortAt, other: PortAt): Refused {
  const words = (at: PortAt) =>
    `the ${PORT_WORDS[at.kind]} ${at.port.name} of ${machine.state(at.path)?.name}`;
  return refused(
    `No value can flow between ${words(one)} and ${words(other)}: connect an output of a state, or an input or scoped variable of its container, to an input of a state, or an output or scoped variable of its container.`,
  );
}

/** Edits for the data flow with all ports between; those that carry the value already are used. */
export function flowEdits(
  machine: Machine,
  { source, target, begin, end }: Course,
  ignored?: { readonly path: string; readonly id: number },
): Edit[] | Refused {
  const bad = pairRefused(source, target);
  if (bad) return bad;
  const meeting = commonPath([begin, end]) ?? begin;
  const chain = new Chain(machine, source, ignored);
  for (let level = begin; level !== meeting; level = parentOf(level) ?? meeting) {
    const refusal = chain.out(level);
    if (refusal) return refusal;
  }
  let level = meeting;
  for (const inner of between(meeting, end)) {
    const refusal = chain.into(level, inner);
    if (refusal) return refusal;
    level = inner;
  }
  return chain.finish(level, target) ?? chain.edits;
}

function pairRefused(source: PortAt, target: PortAt): Refused | null {
  if (source.path === target.path && source.port.id === target.port.id) {
    return refused("A data flow must end at another port.");
  }
  const variables = [source, target].every(({ kind }) => kind === "scoped_variable");
  if (variables && source.path === target.path) {
    return refused(
      "No value can flow from one scoped variable to another: let a state pass it on.",
    );
  }
  const [from, to] = [source.port, target.port];
  return fits(from.data_type, to.data_type)
    ? null
    : refused(
        `${from.name} is of the type ${shortType(from.data_type)} and does not fit ${to.name} of the type ${shortType(to.data_type)}: change one of the types, or use object.`,
      );
}

/** Paths from below `outer` down to `inner`. */
function between(outer: string, inner: string): readonly string[] {
  const found: string[] = [];
  for (let path: string | null = inner; path !== null && path !== outer; path = parentOf(path)) {
    found.unshift(path);
  }
  return found;
}

/** Follows the value from level to level and collects what has to be made for it. */
class Chain {
  readonly edits: Edit[] = [];
  readonly #machine: Machine;
  readonly #port: PortDocument;
  readonly #ignored: { readonly path: string; readonly id: number } | undefined;
  /** Present position of the value: state and port. */
  #state: string;
  #id: number;

  constructor(
    machine: Machine,
    source: PortAt,
    ignored: { readonly path: string; readonly id: number } | undefined,
  ) {
    this.#machine = machine;
    this.#port = source.port;
    this.#ignored = ignored;
    this.#state = idOf(source.path);
    this.#id = source.port.id;
  }

  /** Out of a container, through one of its outputs. */
  out(path: string): Refused | null {
    const container = containerAt(this.#machine, path);
    if (isRefused(container)) return container;
    return this.#pass(path, container, path, container, "output");
  }

  /** Into a child of a container, through one of its inputs. */
  into(path: string, child: string): Refused | null {
    const container = containerAt(this.#machine, path);
    const state = containerAt(this.#machine, child);
    if (isRefused(container)) return container;
    if (isRefused(state)) return state;
    return this.#pass(path, container, child, state, "input");
  }

  finish(path: string, target: PortAt): Refused | null {
    const container = containerAt(this.#machine, path);
    if (isRefused(container)) return container;
    const to = idOf(target.path);
    const twin = this.#flows(path, container).some(
      (flow) => flow.to_state === to && flow.to_port === target.port.id,
    );
    if (twin) return refused(`${this.#port.name} already flows to ${target.port.name}.`);
    this.#flow(path, container, to, target.port.id);
    return null;
  }

  #pass(
    path: string,
    container: StateDocument,
    owner: string,
    state: StateDocument,
    kind: "input" | "output",
  ): Refused | null {
    const ports = portsOf(state, kind);
    const to = idOf(owner);
    const type = shortType(this.#port.data_type);
    const known = this.#flows(path, container)
      .filter(({ to_state }) => to_state === to)
      .map(({ to_port }) => ports.find(({ id }) => id === to_port))
      .find((port) => port && shortType(port.data_type) === type);
    const id = known?.id ?? freshNumber(allPorts(state));
    if (!known) {
      const name = freshName(
        this.#port.name,
        ports.map((port) => port.name),
      );
      const value = this.#port.default ?? null;
      const place = { path: owner, list: kind, port: id };
      this.edits.push({ edit: "add_port", ...place, name, data_type: type, default: value });
      this.#flow(path, container, to, id);
    }
    this.#state = to;
    this.#id = id;
    return null;
  }

  /** Flows of the container that carry the value from where it has come. */
  #flows(path: string, container: StateDocument) {
    return dataFlowsOf(container).filter(
      ({ id, from_state, from_port }) =>
        from_state === this.#state &&
        from_port === this.#id &&
        !(this.#ignored?.path === path && this.#ignored.id === id),
    );
  }

  #flow(path: string, container: StateDocument, state: string, port: number): void {
    const data_flow = freshNumber(dataFlowsOf(container));
    const from = { state: this.#state, port: this.#id };
    this.edits.push({ edit: "add_data_flow", path, data_flow, from, to: { state, port } });
  }
}

/** The port that a state has to get so that a flow from or to the other port can end at it. */
export function fittingPort(machine: Machine, other: PortAt, path: string): PortAt | Refused {
  const state = machine.state(path);
  if (!state) return refused("This state no longer exists: someone may have removed it.");
  if (state.kind === "library") {
    return refused(
      `${state.name} is a library: its ports are those of the library, so connect to one of them.`,
    );
  }
  if (other.path === path) return refused(`${other.port.name} is a port of ${state.name} itself.`);
  const kind = kindFor(other, path);
  const ports = portsOf(state, kind);
  const name = freshName(
    other.port.name,
    ports.map((port) => port.name),
  );
  const id = freshNumber(allPorts(state));
  const port = {
    id,
    name,
    data_type: shortType(other.port.data_type),
    default: other.port.default ?? null,
  };
  return { path, kind, port };
}

/** The kind of the port in its containers, so that the value continues; elsewhere the opposite kind. */
function kindFor(other: PortAt, path: string): "input" | "output" {
  const isAround = other.path.startsWith(`${path}/`);
  const gives = other.kind === "output" || (other.kind === "scoped_variable" && isAround);
  if (isAround) return gives ? "output" : "input";
  if (other.kind === "scoped_variable") return "input";
  const isInside = path.startsWith(`${other.path}/`);
  if (isInside) return other.kind === "input" ? "input" : "output";
  return other.kind === "output" ? "input" : "output";
}

/** The edit that makes a port. */
export function portEdit({ path, kind, port }: PortAt): Edit {
  const { id, name, data_type } = port;
  return {
    edit: "add_port",
    path,
    list: kind,
    port: id,
    name,
    data_type,
    default: port.default ?? null,
  };
}
