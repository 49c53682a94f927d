/** Outcomes, data ports, scoped variables, and the values that library states set for ports. */

import type { ElementRef } from "../model/element.ts";
import { type DataPort, endInWords, flowEnds, isPort } from "../model/ends.ts";
import type { Edit, JsonValue, PortDocument, StateDocument } from "../model/generated/protocol.ts";
import {
  dataFlowsOf,
  isContainer,
  type Machine,
  outcomesOf,
  type PortKind,
  portsOf,
} from "../model/machine.ts";
import { freshNumber, numberedName } from "../model/names.ts";
import { parentOf } from "../model/path.ts";
import { defaultOf, fits, isTypeName, shortType, valueFits } from "../model/types.ts";
import { python } from "../model/value.ts";
import { article, interfaceAt, KIND_WORDS, stateAt } from "./legal.ts";
import { isRefused, type Planned, type Refused, refused, together } from "./plan.ts";

export const PORT_WORDS: Readonly<Record<PortKind, string>> = {
  input: "input",
  output: "output",
  scoped_variable: "scoped variable",
};

const BASES: Readonly<Record<PortKind, string>> = {
  input: "input",
  output: "output",
  scoped_variable: "scoped",
};

/** All ports of a state: their ids are unique together. */
export function allPorts(state: StateDocument): readonly PortDocument[] {
  return (["input", "output", "scoped_variable"] as const).flatMap((kind) => portsOf(state, kind));
}

export function addOutcome(machine: Machine, path: string, name?: string): Planned {
  const state = interfaceAt(machine, path);
  if (isRefused(state)) return state;
  const taken = outcomesOf(state);
  const outcomeName = name?.trim() ?? newOutcomeName(state);
  const bad = nameRefused(
    "outcome",
    outcomeName,
    taken.map((each) => each.name),
  );
  if (bad) return bad;
  const outcome = freshNumber(taken);
  return {
    name: `Add outcome ${outcomeName}`,
    edit: { edit: "add_outcome", path, outcome, name: outcomeName },
    select: [{ kind: "outcome", path, id: outcome }],
  };
}

function newOutcomeName(state: StateDocument): string {
  const names = outcomesOf(state).map(({ name }) => name);
  return names.includes("success") ? numberedName("success", names) : "success";
}

/** Properties of a new port. */
interface NewPort {
  readonly name?: string;
  readonly data_type?: string;
  readonly default?: JsonValue;
}

export function addPort(
  machine: Machine,
  path: string,
  kind: PortKind,
  port: NewPort = {},
): Planned {
  const state = interfaceAt(machine, path);
  if (isRefused(state)) return state;
  if (kind === "scoped_variable" && !isContainer(state)) {
    return refused(
      `${state.name} is of the kind ${KIND_WORDS[state.kind]}: only containers have scoped variables.`,
    );
  }
  const names = portsOf(state, kind).map(({ name }) => name);
  const name = port.name?.trim() ?? numberedName(BASES[kind], names);
  const data_type = shortType(port.data_type ?? "int");
  const value = port.default === undefined ? defaultOf(data_type) : port.default;
  const bad =
    nameRefused(PORT_WORDS[kind], name, names) ??
    typeRefused(data_type) ??
    valueRefused(name, value, data_type);
  if (bad) return bad;
  const id = freshNumber(allPorts(state));
  return {
    name: `Add ${PORT_WORDS[kind]} ${name}`,
    edit: { edit: "add_port", path, list: kind, port: id, name, data_type, default: value },
    select: [{ kind, path, id }],
  };
}

function nameRefused(what: string, name: string, taken: readonly string[]): Refused | undefined {
  if (name === "") return refused(`The name of ${article(what)} must have at least one character.`);
  return taken.includes(name)
    ? refused(`Another ${what} has the name ${name}: choose a different one.`)
    : undefined;
}

function typeRefused(type: string): Refused | undefined {
  return isTypeName(type)
    ? undefined
    : refused(`${type} is not a type: write it as in Python, such as int or numpy.ndarray.`);
}

function valueRefused(name: string, value: JsonValue, type: string): Refused | undefined {
  return valueFits(value, type)
    ? undefined
    : refused(
        `${python(value)} is not of the type ${type}, which ${name} has: change one of the two.`,
      );
}

export function renameOutcome(machine: Machine, element: ElementRef, name: string): Planned {
  const state = interfaceAt(machine, element.path);
  if (isRefused(state)) return state;
  const found =
    element.kind === "outcome" ? outcomesOf(state).find(({ id }) => id === element.id) : undefined;
  if (!found) return gone("outcome", state);
  const others = outcomesOf(state).filter((other) => other !== found);
  const text = name.trim();
  const bad = nameRefused(
    "outcome",
    text,
    others.map((other) => other.name),
  );
  if (bad) return bad;
  const edit: Edit = { edit: "rename_outcome", path: element.path, outcome: found.id, name: text };
  return { name: `Rename outcome ${found.name}`, edit };
}

function gone(what: string, state: StateDocument): Refused {
  return refused(`${state.name} no longer has this ${what}.`);
}

interface FoundPort {
  readonly state: StateDocument;
  readonly port: PortDocument;
  readonly at: DataPort;
}

function findPort(
  machine: Machine,
  element: ElementRef,
  allowed: (machine: Machine, path: string) => StateDocument | Refused,
): FoundPort | Refused {
  const state = allowed(machine, element.path);
  if (isRefused(state)) return state;
  if (!isPort(element)) return gone("port", state);
  const port = portsOf(state, element.kind).find(({ id }) => id === element.id);
  return port ? { state, port, at: element } : gone(PORT_WORDS[element.kind], state);
}

export function renamePort(machine: Machine, element: ElementRef, name: string): Planned {
  const found = findPort(machine, element, interfaceAt);
  if (isRefused(found)) return found;
  const { state, port, at } = found;
  const others = portsOf(state, at.kind).filter((other) => other !== port);
  const text = name.trim();
  const bad = nameRefused(
    PORT_WORDS[at.kind],
    text,
    others.map((other) => other.name),
  );
  if (bad) return bad;
  const edit: Edit = { edit: "rename_port", path: at.path, list: at.kind, port: at.id, name: text };
  return { name: `Rename ${PORT_WORDS[at.kind]} ${port.name}`, edit };
}

/** A flow at the port that the type would not fit. */
function flowsRefused(machine: Machine, at: DataPort, type: string): Refused | undefined {
  for (const { container, gives, other } of flowsAt(machine, at)) {
    const found = typeAt(machine, other);
    if (found === null || (gives ? fits(type, found) : fits(found, type))) continue;
    return refused(
      `A data flow connects it with ${endInWords(machine, container, other)} of the type ${shortType(found)}, which does not fit ${type}: delete the data flow first, or use object.`,
    );
  }
  return undefined;
}

interface FlowAt {
  readonly container: string;
  readonly gives: boolean;
  readonly other: ElementRef;
}

/** The data flows at a port, inside and outside of its state. */
function flowsAt(machine: Machine, at: DataPort): readonly FlowAt[] {
  const parent = parentOf(at.path);
  const containers = parent === null ? [at.path] : [at.path, parent];
  return containers.flatMap((container) => {
    const state = machine.state(container);
    return (state ? dataFlowsOf(state) : []).flatMap((flow): FlowAt[] => {
      const ends = flowEnds(machine, container, flow);
      if (ends && isSame(ends.from, at)) return [{ container, gives: true, other: ends.to }];
      if (ends && isSame(ends.to, at)) return [{ container, gives: false, other: ends.from }];
      return [];
    });
  });
}

function isSame(element: ElementRef, at: DataPort): boolean {
  return isPort(element) && element.path === at.path && element.id === at.id;
}

function typeAt(machine: Machine, element: ElementRef): string | null {
  const state = machine.state(element.path);
  if (!state || !isPort(element)) return null;
  return portsOf(state, element.kind).find(({ id }) => id === element.id)?.data_type ?? null;
}

/** Another type; a default that no longer fits becomes the type's own. */
export function setPortType(machine: Machine, element: ElementRef, type: string): Planned {
  const found = findPort(machine, element, interfaceAt);
  if (isRefused(found)) return found;
  const { port, at } = found;
  const data_type = shortType(type);
  const bad = typeRefused(data_type) ?? flowsRefused(machine, at, data_type);
  if (bad) return bad;
  const place = { path: at.path, list: at.kind, port: at.id };
  const set: Edit = { edit: "set_port_type", ...place, data_type };
  const name = `Change type of ${port.name}`;
  if (valueFits(port.default ?? null, data_type)) return { name, edit: set };
  const empty: Edit = { edit: "set_port_default", ...place, default: null };
  const value: Edit = { edit: "set_port_default", ...place, default: defaultOf(data_type) };
  return { name, edit: together([empty, set, value]) };
}

export function setPortDefault(machine: Machine, element: ElementRef, value: JsonValue): Planned {
  const found = findPort(machine, element, interfaceAt);
  if (isRefused(found)) return found;
  const { port, at } = found;
  const bad = valueRefused(port.name, value, port.data_type);
  if (bad) return bad;
  const edit: Edit = {
    edit: "set_port_default",
    path: at.path,
    list: at.kind,
    port: at.id,
    default: value,
  };
  return { name: `Change default of ${port.name}`, edit };
}

function libraryPort(machine: Machine, element: ElementRef): FoundPort | Refused {
  const found = findPort(machine, element, stateAt);
  if (isRefused(found) || found.state.kind === "library") return found;
  return refused(`${found.state.name} is not a library: change the default of ${found.port.name}.`);
}

/** Sets what a library gets at a port instead of its default. */
export function setRuntimeValue(machine: Machine, element: ElementRef, value: JsonValue): Planned {
  const found = libraryPort(machine, element);
  if (isRefused(found)) return found;
  const { port, at } = found;
  const bad = valueRefused(port.name, value, port.data_type);
  if (bad) return bad;
  const edit: Edit = {
    edit: "set_runtime_value",
    path: at.path,
    list: at.kind,
    port: at.id,
    value,
  };
  return { name: `Change value of ${port.name}`, edit };
}

/** Selects the value of the library state or the library's default. A missing value is the default. */
export function useRuntimeValue(machine: Machine, element: ElementRef, used: boolean): Planned {
  const found = libraryPort(machine, element);
  if (isRefused(found)) return found;
  const { state, port, at } = found;
  const values = at.kind === "input" ? state.library?.inputs : state.library?.outputs;
  const place = { path: at.path, list: at.kind, port: at.id };
  const known = values?.some((value) => value.port === at.id) ?? false;
  const name = `${used ? "Use" : "Do not use"} the value of ${port.name}`;
  if (known) return { name, edit: { edit: "use_runtime_value", ...place, used } };
  if (!used) return refused(`${port.name} already has the library's default.`);
  const edit: Edit = { edit: "set_runtime_value", ...place, value: port.default ?? null };
  return { name, edit };
}
