/** Copying and pasting ports and outcomes: between states, and of ports as another kind. */

import type { ElementRef } from "../model/element.ts";
import { type DataPort, isPort } from "../model/ends.ts";
import type { Edit, JsonValue, PortDocument, StateDocument } from "../model/generated/protocol.ts";
import { isContainer, type Machine, outcomesOf, type PortKind, portsOf } from "../model/machine.ts";
import { freshName, freshNumber } from "../model/names.ts";
import { interfaceAt, KIND_WORDS } from "./legal.ts";
import { isRefused, type Planned, refused, together } from "./plan.ts";
import { allPorts, PORT_WORDS } from "./ports.ts";

export type PartKind = PortKind | "outcome";

/** A port or outcome without its state. */
export type InterfacePart =
  | { readonly kind: "outcome"; readonly name: string }
  | {
      readonly kind: PortKind;
      readonly name: string;
      readonly data_type: string;
      readonly default: JsonValue;
    };

/** The ports and outcomes among the elements; aborted and preempted have their places everywhere already. */
export function partsOf(
  machine: Machine,
  elements: readonly ElementRef[],
): readonly InterfacePart[] {
  return elements.flatMap((element): readonly InterfacePart[] => {
    const state = machine.state(element.path);
    if (!state) return [];
    if (element.kind === "outcome") return outcomeParts(state, element.id);
    return isPort(element) ? portParts(state, element) : [];
  });
}

function outcomeParts(state: StateDocument, id: number): readonly InterfacePart[] {
  const outcomes = outcomesOf(state).filter((outcome) => outcome.id === id && id >= 0);
  return outcomes.map(({ name }) => ({ kind: "outcome", name }));
}

function portParts(state: StateDocument, { kind, id }: DataPort): readonly InterfacePart[] {
  const ports = portsOf(state, kind).filter((port) => port.id === id);
  return ports.map((port) => partOf(kind, port));
}

export function partOf(kind: PortKind, { name, data_type, ...port }: PortDocument): InterfacePart {
  return { kind, name, data_type, default: port.default ?? null };
}

/** Adds the parts to a state under names that are free there; `as` makes all ports of one kind. */
export function pasteParts(
  machine: Machine,
  path: string,
  parts: readonly InterfacePart[],
  as?: PartKind,
): Planned {
  const state = interfaceAt(machine, path);
  if (isRefused(state)) return state;
  const wanted = as === undefined ? parts : parts.flatMap((part) => asKind(part, as));
  const [first] = wanted;
  if (!first) return refused(nothingFits(parts, as));
  const own = wanted.filter(({ kind }) => kind !== "scoped_variable" || isContainer(state));
  if (own.length === 0) {
    return refused(
      `${state.name} is of the kind ${KIND_WORDS[state.kind]}: only containers have scoped variables. Paste them in the table of its inputs or outputs.`,
    );
  }
  const added = additions(state, path, own);
  return {
    name: `Paste ${partsInWords(own)}`,
    edit: together(added.map(({ edit }) => edit)),
    select: added.map(({ element }) => element),
  };
}

function asKind(part: InterfacePart, kind: PartKind): readonly InterfacePart[] {
  if (part.kind === "outcome" || kind === "outcome") return part.kind === kind ? [part] : [];
  return [{ ...part, kind }];
}

function nothingFits(parts: readonly InterfacePart[], as: PartKind | undefined): string {
  if (parts.length === 0 || as === undefined) {
    return "There are no ports or outcomes on the clipboard: select some and copy them first.";
  }
  return as === "outcome"
    ? "There are only ports on the clipboard: paste them in a table of ports."
    : "There are only outcomes on the clipboard: paste them in the table of outcomes.";
}

interface Addition {
  readonly edit: Edit;
  readonly element: ElementRef;
}

function additions(
  state: StateDocument,
  path: string,
  parts: readonly InterfacePart[],
): Addition[] {
  const taken = {
    outcome: [...outcomesOf(state)],
    input: [...portsOf(state, "input")],
    output: [...portsOf(state, "output")],
    scoped_variable: [...portsOf(state, "scoped_variable")],
  };
  const ports: { readonly id: number }[] = [...allPorts(state)];
  return parts.map((part) => {
    const { kind } = part;
    const name = freshName(
      part.name,
      taken[kind].map((other) => other.name),
    );
    const id = freshNumber(kind === "outcome" ? taken.outcome : ports);
    const element: ElementRef = { kind, path, id };
    if (part.kind === "outcome") {
      taken.outcome.push({ id, name });
      return { element, edit: { edit: "add_outcome", path, outcome: id, name } };
    }
    const { data_type, default: value } = part;
    taken[part.kind].push({ id, name, data_type });
    ports.push({ id });
    const port = { list: part.kind, port: id, name, data_type, default: value };
    return { element, edit: { edit: "add_port", path, ...port } };
  });
}

function partsInWords(parts: readonly InterfacePart[]): string {
  const [first] = parts;
  if (parts.length > 1 || !first) return `${parts.length} ports and outcomes`;
  return `${first.kind === "outcome" ? "outcome" : PORT_WORDS[first.kind]} ${first.name}`;
}
