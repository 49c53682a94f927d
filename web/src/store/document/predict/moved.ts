/** Predicts moves and pastes of states, and changes of their ids. */

import type {
  DataFlowDocument,
  Edit,
  Selection,
  StateDocument,
  TransitionDocument,
} from "../../../model/generated/protocol.ts";
import { dataFlowsOf, isContainer, transitionsOf } from "../../../model/machine.ts";
import { childPath, idOf, isWithin, parentOf } from "../../../model/path.ts";
import { placed, withList } from "../lists.ts";
import { lead, remove } from "./children.ts";
import { nextTransition } from "./connections.ts";
import type { PredictedMachine } from "./predicted_machine.ts";

/** Predicts the edit; false if it is of another kind, or if only the server knows its effect. */
export function moved(predicted: PredictedMachine, edit: Edit): boolean {
  switch (edit.edit) {
    case "move_states":
      return move(predicted, edit);
    case "paste":
      return paste(predicted, edit.path, edit.selection, edit.ids);
    case "set_id":
      return setId(predicted, edit.path, edit.id);
    default:
      return false;
  }
}

type Move = Extract<Edit, { edit: "move_states" }>;

function move(predicted: PredictedMachine, { path, states, to, ids }: Move): boolean {
  const container = predicted.state(path);
  if (!container || states.some((id) => isWithin(to, childPath(path, id)))) return false;
  if (to === path) return true;
  const selection = taken(predicted, container, new Set(states), states);
  return states.every((id) => remove(predicted, path, id)) && paste(predicted, to, selection, ids);
}

/** The states with the connections between them. */
function taken(
  predicted: PredictedMachine,
  container: StateDocument,
  ids: ReadonlySet<string>,
  inOrder: readonly string[],
): Selection {
  const isIn = (id: string | null | undefined) => id != null && ids.has(id);
  const { path } = container;
  const states = inOrder.flatMap((id) =>
    predicted.inside(childPath(path, id)).map((state) => ({
      ...state,
      path: state.path.slice(path.length + 1),
    })),
  );
  return {
    container: idOf(path),
    states,
    transitions: transitionsOf(container).filter((t) => isIn(t.from_state) && isIn(t.to_state)),
    data_flows: dataFlowsOf(container).filter((f) => isIn(f.from_state) && isIn(f.to_state)),
  };
}

function paste(
  predicted: PredictedMachine,
  path: string,
  { states = [], scoped_variables = [], transitions = [], data_flows = [] }: Selection,
  ids: readonly string[],
): boolean {
  const target = predicted.state(path);
  if (!target || !isContainer(target) || scoped_variables.length > 0) return false;
  if (states.some((state) => !state.outcomes)) return false;
  const roots = states.filter((state) => parentOf(state.path) === null);
  const newIds = new Map(roots.map((root, at) => [root.path, ids[at] ?? root.path]));
  const isFree = (id: string) => id !== idOf(path) && !predicted.state(childPath(path, id));
  if (new Set(newIds.values()).size < roots.length) return false;
  if (roots.some(({ kind }) => kind === "decider") || ![...newIds.values()].every(isFree)) {
    return false;
  }
  for (const state of states) predicted.put(elsewhere(state, path, newIds));
  for (const root of roots) {
    lead(predicted, predicted.state(path) ?? target, {
      ...root,
      path: newIds.get(root.path) ?? root.path,
    });
  }
  connect(predicted, path, { transitions, data_flows }, newIds);
  return true;
}

/** The state at its new path. Root states may get new ids. */
function elsewhere(
  state: StateDocument,
  container: string,
  newIds: ReadonlyMap<string, string>,
): StateDocument {
  const end = state.path.indexOf("/");
  const root = end < 0 ? state.path : state.path.slice(0, end);
  const id = newIds.get(root) ?? root;
  const path = childPath(container, id + state.path.slice(root.length));
  const own = end < 0 ? withEnds(state, root, id) : state;
  return { ...own, path };
}

function connect(
  predicted: PredictedMachine,
  path: string,
  between: { readonly transitions: TransitionDocument[]; readonly data_flows: DataFlowDocument[] },
  newIds: ReadonlyMap<string, string>,
): void {
  let target = predicted.state(path);
  if (!target) return;
  for (const transition of target.kind === "hierarchy" ? between.transitions : []) {
    const id = nextTransition(target);
    const { from_state, to_state } = transition;
    const ends = {
      ...(from_state == null ? {} : { from_state: newIds.get(from_state) ?? from_state }),
      ...(to_state == null ? {} : { to_state: newIds.get(to_state) ?? to_state }),
    };
    const next = { ...transition, ...ends, id };
    target = withList(target, "transitions", placed(target.transitions, id, next));
  }
  let id = Math.max(0, ...dataFlowsOf(target).map((flow) => flow.id));
  for (const flow of between.data_flows) {
    id += 1;
    const [from_state, to_state] = [newIds.get(flow.from_state), newIds.get(flow.to_state)];
    if (from_state === undefined || to_state === undefined) continue;
    const next = { ...flow, from_state, to_state, id };
    target = withList(target, "data_flows", placed(target.data_flows, id, next));
  }
  predicted.put(target);
}

function setId(predicted: PredictedMachine, path: string, id: string): boolean {
  const state = predicted.state(path);
  const parent = predicted.state(parentOf(path) ?? "");
  if (!state || !parent || state.kind === "decider") return false;
  const old = idOf(path);
  if (id === old) return true;
  const isTaken = [childPath(parent.path, id), childPath(path, id)].some((each) =>
    predicted.state(each),
  );
  if (isTaken || id === idOf(parent.path) || id === "" || id.includes("/")) return false;
  const all = predicted.inside(path);
  predicted.remove(path);
  for (const each of all) {
    const own = each.path === path ? withEnds(each, old, id) : each;
    predicted.put({ ...own, path: childPath(parent.path, id) + each.path.slice(path.length) });
  }
  predicted.put(withEnds(parent, old, id));
  return true;
}

/** The state with its connections moved from the old id to another one. */
function withEnds(state: StateDocument, old: string, id: string): StateDocument {
  if (!isContainer(state) || old === id) return state;
  const end = <T extends string | null | undefined>(at: T) => (at === old ? id : at);
  const transitions = transitionsOf(state).map((transition) => ({
    ...transition,
    ...(transition.from_state === old ? { from_state: id } : {}),
    ...(transition.to_state === old ? { to_state: id } : {}),
  }));
  const flows = dataFlowsOf(state).map((flow) => ({
    ...flow,
    from_state: end(flow.from_state),
    to_state: end(flow.to_state),
  }));
  return withList(withList(state, "transitions", transitions), "data_flows", flows);
}
