/** Predicts edits of outcomes and ports, including their connections. */

import type {
  Edit,
  JsonValue,
  PortDocument,
  PortList,
  StateDocument,
} from "../../../model/generated/protocol.ts";
import {
  dataFlowsOf,
  isContainer,
  outcomesOf,
  type PortKind,
  portsOf,
  transitionsOf,
} from "../../../model/machine.ts";
import { idOf, parentOf } from "../../../model/path.ts";
import { placed, withList } from "../lists.ts";
import { drop } from "./connections.ts";
import { placeKey, withoutPlaces } from "./places.ts";
import type { PredictedMachine } from "./predicted_machine.ts";

const LISTS = { input: "inputs", output: "outputs", scoped_variable: "scoped_variables" } as const;
const KINDS: readonly PortKind[] = ["input", "output", "scoped_variable"];

/** Predicts the edit; false if it is of another kind, or if only the server knows its effect. */
export function ownInterface(predicted: PredictedMachine, edit: Edit): boolean {
  const state = "path" in edit ? predicted.state(edit.path) : undefined;
  if (!state || (state.library && !state.library.missing)) return false;
  switch (edit.edit) {
    case "add_outcome":
      return (
        !hasOutcome(state, edit.outcome) && putOutcome(predicted, state, edit.outcome, edit.name)
      );
    case "rename_outcome":
      return (
        hasOutcome(state, edit.outcome) && putOutcome(predicted, state, edit.outcome, edit.name)
      );
    case "remove_outcome":
      return removeOutcome(predicted, state, edit.outcome);
    case "add_port":
      return addPort(predicted, state, edit);
    case "rename_port":
      return changePort(predicted, state, edit, (port) => ({ ...port, name: edit.name }));
    case "set_port_type":
      return changePort(predicted, state, edit, (port) => ({ ...port, data_type: edit.data_type }));
    case "set_port_default":
      return changePort(predicted, state, edit, (port) => withDefault(port, edit.default));
    case "remove_port":
      return removePort(predicted, state, edit);
    default:
      return false;
  }
}

function hasOutcome(state: StateDocument, id: number): boolean {
  return outcomesOf(state).some((outcome) => outcome.id === id);
}

function putOutcome(
  predicted: PredictedMachine,
  state: StateDocument,
  id: number,
  name: string,
): boolean {
  const earlier = outcomesOf(state).find((outcome) => outcome.id === id);
  const outcomes = placed(state.outcomes, id, { ...earlier, id, name });
  predicted.put(withList(state, "outcomes", outcomes));
  return true;
}

function removeOutcome(predicted: PredictedMachine, state: StateDocument, id: number): boolean {
  if (id < 0 || !hasOutcome(state, id)) return false;
  const own = idOf(state.path);
  const inner = transitionsOf(state).filter((t) => t.to_state === own && t.to_outcome === id);
  drop(predicted, state.path, ids(inner), []);
  const parent = parentState(predicted, state.path);
  if (parent) {
    const leads = transitionsOf(parent).filter(
      (t) => t.from_state === own && t.from_outcome === id,
    );
    drop(predicted, parent.path, ids(leads), []);
  }
  const left = predicted.state(state.path) ?? state;
  const without = withList(left, "outcomes", placed(left.outcomes, id, null));
  predicted.put(withoutPlaces(without, [placeKey("outcome", id)]));
  return true;
}

interface PortEdit {
  readonly list: PortList;
  readonly port: number;
}

function addPort(
  predicted: PredictedMachine,
  state: StateDocument,
  edit: Extract<Edit, { edit: "add_port" }>,
): boolean {
  if (edit.list === "scoped_variable" && !isContainer(state)) return false;
  const isTaken = (kind: PortKind) => portsOf(state, kind).some(({ id }) => id === edit.port);
  if (KINDS.some(isTaken)) return false;
  const { port: id, name, data_type } = edit;
  return putPort(predicted, state, edit.list, withDefault({ id, name, data_type }, edit.default));
}

function changePort(
  predicted: PredictedMachine,
  state: StateDocument,
  { list, port: id }: PortEdit,
  next: (port: PortDocument) => PortDocument,
): boolean {
  const port = portsOf(state, list).find((other) => other.id === id);
  return port !== undefined && putPort(predicted, state, list, next(port));
}

function putPort(
  predicted: PredictedMachine,
  state: StateDocument,
  list: PortList,
  port: PortDocument,
): boolean {
  const name = LISTS[list];
  predicted.put(withList(state, name, placed(state[name], port.id, port)));
  return true;
}

function withDefault(port: PortDocument, value: JsonValue): PortDocument {
  const { default: _, ...rest } = port;
  return value === null ? rest : { ...rest, default: value };
}

function removePort(
  predicted: PredictedMachine,
  state: StateDocument,
  { list, port }: PortEdit,
): boolean {
  if (!portsOf(state, list).some(({ id }) => id === port)) return false;
  const own = idOf(state.path);
  drop(predicted, state.path, [], flowsAt(state, own, port));
  const parent = parentState(predicted, state.path);
  if (parent && list !== "scoped_variable") {
    drop(predicted, parent.path, [], flowsAt(parent, own, port));
  }
  const left = predicted.state(state.path) ?? state;
  const name = LISTS[list];
  const without = withList(left, name, placed(left[name], port, null));
  predicted.put(withoutPlaces(without, [placeKey(list, port)]));
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

function parentState(predicted: PredictedMachine, path: string): StateDocument | undefined {
  const parent = parentOf(path);
  return parent === null ? undefined : predicted.state(parent);
}

function ids(elements: readonly { readonly id: number }[]): readonly number[] {
  return elements.map(({ id }) => id);
}
