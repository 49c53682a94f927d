/** Foretells edits of outcomes and ports, with the connections that go along. */

import type {
  Edit,
  JsonValue,
  PortDocument,
  PortList,
  StateDocument,
} from "../../model/generated/protocol.ts";
import {
  dataFlowsOf,
  isContainer,
  outcomesOf,
  type PortKind,
  portsOf,
  transitionsOf,
} from "../../model/machine.ts";
import { idOf, parentOf } from "../../model/path.ts";
import { placed, withList } from "../lists.ts";
import { drop } from "./connections.ts";
import type { Draft } from "./draft.ts";
import { placeKey, withoutPlaces } from "./places.ts";

const LISTS = { input: "inputs", output: "outputs", scoped_variable: "scoped_variables" } as const;
const KINDS: readonly PortKind[] = ["input", "output", "scoped_variable"];

/** Writes what the edit does; false if it is another kind of edit, or if only the server knows. */
export function ownInterface(draft: Draft, edit: Edit): boolean {
  const state = "path" in edit ? draft.state(edit.path) : undefined;
  if (!state || (state.library && !state.library.missing)) return false;
  switch (edit.edit) {
    case "add_outcome":
      return !hasOutcome(state, edit.outcome) && putOutcome(draft, state, edit.outcome, edit.name);
    case "rename_outcome":
      return hasOutcome(state, edit.outcome) && putOutcome(draft, state, edit.outcome, edit.name);
    case "remove_outcome":
      return removeOutcome(draft, state, edit.outcome);
    case "add_port":
      return addPort(draft, state, edit);
    case "rename_port":
      return changePort(draft, state, edit, (port) => ({ ...port, name: edit.name }));
    case "set_port_type":
      return changePort(draft, state, edit, (port) => ({ ...port, data_type: edit.data_type }));
    case "set_port_default":
      return changePort(draft, state, edit, (port) => withDefault(port, edit.default));
    case "remove_port":
      return removePort(draft, state, edit);
    default:
      return false;
  }
}

function hasOutcome(state: StateDocument, id: number): boolean {
  return outcomesOf(state).some((outcome) => outcome.id === id);
}

function putOutcome(draft: Draft, state: StateDocument, id: number, name: string): boolean {
  const earlier = outcomesOf(state).find((outcome) => outcome.id === id);
  const outcomes = placed(state.outcomes, id, { ...earlier, id, name });
  draft.put(withList(state, "outcomes", outcomes));
  return true;
}

function removeOutcome(draft: Draft, state: StateDocument, id: number): boolean {
  if (id < 0 || !hasOutcome(state, id)) return false;
  const own = idOf(state.path);
  const inner = transitionsOf(state).filter((t) => t.to_state === own && t.to_outcome === id);
  drop(draft, state.path, ids(inner), []);
  const parent = parentState(draft, state.path);
  if (parent) {
    const leads = transitionsOf(parent).filter(
      (t) => t.from_state === own && t.from_outcome === id,
    );
    drop(draft, parent.path, ids(leads), []);
  }
  const left = draft.state(state.path) ?? state;
  const without = withList(left, "outcomes", placed(left.outcomes, id, null));
  draft.put(withoutPlaces(without, [placeKey("outcome", id)]));
  return true;
}

interface PortEdit {
  readonly list: PortList;
  readonly port: number;
}

function addPort(
  draft: Draft,
  state: StateDocument,
  edit: Extract<Edit, { edit: "add_port" }>,
): boolean {
  if (edit.list === "scoped_variable" && !isContainer(state)) return false;
  const isTaken = (kind: PortKind) => portsOf(state, kind).some(({ id }) => id === edit.port);
  if (KINDS.some(isTaken)) return false;
  const { port: id, name, data_type } = edit;
  return putPort(draft, state, edit.list, withDefault({ id, name, data_type }, edit.default));
}

function changePort(
  draft: Draft,
  state: StateDocument,
  { list, port: id }: PortEdit,
  next: (port: PortDocument) => PortDocument,
): boolean {
  const port = portsOf(state, list).find((other) => other.id === id);
  return port !== undefined && putPort(draft, state, list, next(port));
}

function putPort(draft: Draft, state: StateDocument, list: PortList, port: PortDocument): boolean {
  const name = LISTS[list];
  draft.put(withList(state, name, placed(state[name], port.id, port)));
  return true;
}

function withDefault(port: PortDocument, value: JsonValue): PortDocument {
  const { default: _, ...rest } = port;
  return value === null ? rest : { ...rest, default: value };
}

function removePort(draft: Draft, state: StateDocument, { list, port }: PortEdit): boolean {
  if (!portsOf(state, list).some(({ id }) => id === port)) return false;
  const own = idOf(state.path);
  drop(draft, state.path, [], flowsAt(state, own, port));
  const parent = parentState(draft, state.path);
  if (parent && list !== "scoped_variable") {
    drop(draft, parent.path, [], flowsAt(parent, own, port));
  }
  const left = draft.state(state.path) ?? state;
  const name = LISTS[list];
  const without = withList(left, name, placed(left[name], port, null));
  draft.put(withoutPlaces(without, [placeKey(list, port)]));
  return true;
}

function flowsAt(container: StateDocument, state: string, port: number): readonly number[] {
  const isThere = (end: string, at: number) => end === state && at === port;
  return ids(
    dataFlowsOf(container).filter(
      (flow) => isThere(flow.from_state, flow.from_port) || isThere(flow.to_state, flow.to_port),
    ),
  );
}

function parentState(draft: Draft, path: string): StateDocument | undefined {
  const parent = parentOf(path);
  return parent === null ? undefined : draft.state(parent);
}

function ids(elements: readonly { readonly id: number }[]): readonly number[] {
  return elements.map(({ id }) => id);
}
