/** Edits that add and remove states with their parts, and change properties of states. */

import { type ElementRef, keyOf } from "../model/element.ts";
import type { Edit, JsonValue, StateDocument, StateKind } from "../model/generated/protocol.ts";
import type { Point } from "../model/geometry.ts";
import {
  ABORTED,
  DECIDER_ID,
  type Machine,
  outcomesOf,
  PREEMPTED,
  startOf,
} from "../model/machine.ts";
import { childPath, idOf, isWithin, parentOf } from "../model/path.ts";
import { pins } from "./boxes.ts";
import { containerAt, counted, interfaceAt, KIND_WORDS, movableFrom, stateAt } from "./legal.ts";
import { type LibraryToInsert, type NewKind, newBox, newLibrary, newState } from "./newcomers.ts";
import { isRefused, type Plan, type Planned, type Refused, refused, together } from "./plan.ts";

/** Adds a state with its middle at a point of the container, or where there is room. */
export function addState(
  machine: Machine,
  container: string,
  kind: NewKind,
  at?: Point,
  name?: string,
): Planned {
  const around = containerAt(machine, container);
  if (isRefused(around)) return around;
  const state = newState(machine, container, kind, newBox(machine, container, at), name);
  const plan = added(machine, container, around, [state], `Add ${KIND_WORDS[kind]}`);
  if (kind !== "barrier") return plan;
  const path = childPath(childPath(container, state.path), DECIDER_ID);
  const body: Edit = { edit: "set_script", path, script: DECIDER_SCRIPT };
  const edits = plan.edit.edit === "batch" ? plan.edit.edits : [plan.edit];
  return { ...plan, edit: together([...edits, body]) };
}

/** Initial script of a new barrier's decider. */
const DECIDER_SCRIPT = `def execute(self, inputs, outputs, gvm):
    # How a child ended: self.get_outcome_for_state_name("its name").name
    return "success"
`;

/** Adds a state that runs a library. */
export function addLibrary(
  machine: Machine,
  container: string,
  library: LibraryToInsert,
  root: StateDocument,
  at?: Point,
): Planned {
  const around = containerAt(machine, container);
  if (isRefused(around)) return around;
  const state = newLibrary(machine, container, library, root, at);
  return added(machine, container, around, [state], `Add library ${library.name}`);
}

/** The edit that adds a state with its content. The first state of a hierarchy becomes its start. */
export function added(
  machine: Machine,
  container: string,
  around: StateDocument,
  states: StateDocument[],
  name: string,
): Plan {
  const id = states[0]?.path ?? "";
  const edits: Edit[] = [
    ...pins(machine, container, new Set()),
    { edit: "add_state", path: container, states },
  ];
  const isFirst = machine.children(container).length === 0 && !startOf(around);
  if (around.kind === "hierarchy" && isFirst) {
    edits.push({ edit: "set_start", path: container, to: { state: id } });
  }
  return { name, edit: together(edits), select: [{ kind: "state", path: `${container}/${id}` }] };
}

/** Removes whatever can be removed of the elements; what belongs to a removed state goes with it. */
export function removeElements(machine: Machine, elements: readonly ElementRef[]): Planned {
  const outer = withoutInner(elements);
  const edits: Edit[] = [];
  const removed: ElementRef[] = [];
  let reason: Refused | null = null;
  for (const element of [...outer].sort((one, other) => rank(one) - rank(other))) {
    const edit = removal(machine, element);
    if (isRefused(edit)) reason ??= edit;
    else {
      edits.push(edit);
      removed.push(element);
    }
  }
  if (edits.length === 0) return reason ?? refused("Nothing is selected that can be deleted.");
  const name = `Delete ${removedWords(removed)}`;
  return { name, edit: together([...stays(machine, removed), ...edits]), select: [] };
}

/** Connections first: they would go with their ends. */
function rank({ kind }: ElementRef): number {
  if (kind === "transition" || kind === "data_flow") return 0;
  return kind === "state" ? 2 : 1;
}

function withoutInner(elements: readonly ElementRef[]): readonly ElementRef[] {
  const states = elements.filter(({ kind }) => kind === "state");
  const isInner = (element: ElementRef) =>
    states.some(
      (state) =>
        keyOf(state) !== keyOf(element) &&
        isWithin(element.path, state.path) &&
        (element.kind !== "state" || element.path !== state.path),
    );
  const unique = new Map(elements.map((element) => [keyOf(element), element]));
  return [...unique.values()].filter((element) => !isInner(element));
}

/** Pins for those that stay in the containers of removed states. */
function stays(machine: Machine, removed: readonly ElementRef[]): Edit[] {
  const gone = new Set(removed.flatMap(({ kind, path }) => (kind === "state" ? [path] : [])));
  const containers = new Set([...gone].map((path) => parentOf(path) ?? path));
  return [...containers].flatMap((container) => pins(machine, container, gone));
}

function removal(machine: Machine, element: ElementRef): Edit | Refused {
  const { path } = element;
  switch (element.kind) {
    case "state": {
      const container = movableFrom(machine, path);
      if (typeof container !== "string") return container;
      return { edit: "remove_state", path: container, state: idOf(path) };
    }
    case "income":
      return refused("Every state has an income: delete the transition that starts there.");
    case "transition":
    case "data_flow": {
      const state = stateAt(machine, path);
      if (isRefused(state)) return state;
      return element.kind === "transition"
        ? { edit: "remove_transition", path, transition: element.id }
        : { edit: "remove_data_flow", path, data_flow: element.id };
    }
    default:
      return partRemoval(machine, element);
  }
}

function partRemoval(
  machine: Machine,
  element: Exclude<ElementRef, { kind: "state" | "income" }>,
): Edit | Refused {
  const { path, kind, id } = element;
  const state = interfaceAt(machine, path);
  if (isRefused(state)) return state;
  if (kind === "input" || kind === "output" || kind === "scoped_variable") {
    return { edit: "remove_port", path, list: kind, port: id };
  }
  if (id === ABORTED || id === PREEMPTED) {
    const name = outcomesOf(state).find((outcome) => outcome.id === id)?.name ?? "This outcome";
    return refused(`${name} is an outcome of every state: leave it unconnected instead.`);
  }
  return { edit: "remove_outcome", path, outcome: id };
}

const WORDS: Readonly<Record<ElementRef["kind"], string>> = {
  state: "state",
  income: "income",
  outcome: "outcome",
  input: "input",
  output: "output",
  scoped_variable: "scoped variable",
  transition: "transition",
  data_flow: "data flow",
};

function removedWords(removed: readonly ElementRef[]): string {
  const [first] = removed;
  const same = first && removed.every(({ kind }) => kind === first.kind);
  return counted(removed.length, same ? WORDS[first.kind] : "element");
}

export function rename(machine: Machine, path: string, name: string): Planned {
  const state = stateAt(machine, path);
  if (isRefused(state)) return state;
  const text = name.trim();
  if (text === "") return refused(`A state needs a name: ${state.name} keeps its name.`);
  if (text.includes("/")) return refused("The name of a state cannot contain a slash (/).");
  return { name: `Rename ${state.name}`, edit: { edit: "set_name", path, name: text } };
}

/** Another id; connections follow. */
export function setId(machine: Machine, path: string, id: string): Planned {
  const state = stateAt(machine, path);
  if (isRefused(state)) return state;
  const text = id.trim();
  if (text === "" || text.includes("/")) {
    return refused("An id must have at least one character and cannot contain a slash (/).");
  }
  if (state.kind === "decider") return refused("The decider of a barrier keeps its id.");
  const parent = parentOf(path);
  const taken =
    parent !== null &&
    (idOf(parent) === text ||
      machine.children(parent).some((other) => other !== path && idOf(other) === text));
  const inner = machine.children(path).some((child) => idOf(child) === text);
  if (taken || inner) return refused(`Another state has the id ${text}: choose a different one.`);
  const now = parent === null ? text : `${parent}/${text}`;
  const select: readonly ElementRef[] = [{ kind: "state", path: now }];
  return { name: `Change id of ${state.name}`, edit: { edit: "set_id", path, id: text }, select };
}

/** Makes the state the one where its container starts. */
export function setStart(machine: Machine, path: string): Planned {
  const container = movableFrom(machine, path);
  if (typeof container !== "string") return container;
  const around = containerAt(machine, container);
  if (isRefused(around)) return around;
  if (around.kind !== "hierarchy") {
    return refused(`${around.name} runs all its states at once: it has no start.`);
  }
  const name = `Start at ${machine.state(path)?.name ?? idOf(path)}`;
  return { name, edit: { edit: "set_start", path: container, to: { state: idOf(path) } } };
}

/** Takes the start of a container away. */
export function clearStart(machine: Machine, container: string): Planned {
  const around = containerAt(machine, container);
  if (isRefused(around)) return around;
  if (!startOf(around)) return refused(`${around.name} already has no start.`);
  const name = `Remove the start of ${around.name}`;
  return { name, edit: { edit: "set_start", path: container, to: null } };
}

export function changeKind(machine: Machine, path: string, kind: StateKind): Planned {
  const state = stateAt(machine, path);
  if (isRefused(state)) return state;
  if (state.kind === kind) return refused(`${state.name} is already of this kind.`);
  if (state.kind === "decider") {
    return refused(`${state.name} is the decider of its barrier and stays one.`);
  }
  if (state.kind === "library") {
    return refused(
      `${state.name} runs a library: replace it with a copy of its content first (Substitute by the library's content).`,
    );
  }
  if (kind === "library") {
    return refused("A state becomes a library state by substitution: choose a library for it.");
  }
  if (kind === "decider")
    return refused("Only a barrier has a decider, and it is created with the barrier.");
  const edit: Edit = { edit: "set_kind", path, kind };
  return { name: `Make ${state.name} a ${KIND_WORDS[kind]}`, edit };
}

export function setDescription(machine: Machine, path: string, text: string): Planned {
  const state = stateAt(machine, path);
  if (isRefused(state)) return state;
  const description = text === "" ? null : text;
  return { name: `Describe ${state.name}`, edit: { edit: "set_description", path, description } };
}

export function setScript(machine: Machine, path: string, script: string): Planned {
  const state = stateAt(machine, path);
  if (isRefused(state)) return state;
  if (state.kind !== "execution" && state.kind !== "decider") {
    return refused(`${state.name} is of the kind ${KIND_WORDS[state.kind]} and has no script.`);
  }
  return { name: `Edit script of ${state.name}`, edit: { edit: "set_script", path, script } };
}

/** Notes of the user: an object, or null for none. */
export function setSemanticData(machine: Machine, path: string, value: JsonValue | null): Planned {
  const state = stateAt(machine, path);
  if (isRefused(state)) return state;
  if (value !== null && (typeof value !== "object" || Array.isArray(value))) {
    return refused("Semantic data consists of keys with values: put the value under a key.");
  }
  const isEmpty = value !== null && Object.keys(value).length === 0;
  const edit: Edit = {
    edit: "set_semantic_data",
    path,
    semantic_data: isEmpty ? null : value,
  };
  return { name: `Change semantic data of ${state.name}`, edit };
}
