/** Predicts the addition and removal of states. */

import type { Edit, OutcomeDocument, StateDocument } from "../../../model/generated/protocol.ts";
import {
  ABORTED,
  dataFlowsOf,
  isContainer,
  outcomesOf,
  PREEMPTED,
  transitionsOf,
} from "../../../model/machine.ts";
import { childPath, idOf } from "../../../model/path.ts";
import { placed, withList } from "../lists.ts";
import { drop, nextTransition } from "./connections.ts";
import type { PredictedMachine } from "./predicted_machine.ts";

export const DECIDER = "unique_decider_state_id";
const MANDATORY: readonly OutcomeDocument[] = [
  { id: PREEMPTED, name: "preempted" },
  { id: ABORTED, name: "aborted" },
];

/** Predicts the edit; false if it is of another kind, or if only the server knows its effect. */
export function children(predicted: PredictedMachine, edit: Edit): boolean {
  if (edit.edit === "add_state") return add(predicted, edit.path, edit.states);
  if (edit.edit === "remove_state") return remove(predicted, edit.path, edit.state);
  return false;
}

function add(predicted: PredictedMachine, path: string, states: readonly StateDocument[]): boolean {
  const parent = predicted.state(path);
  const [first] = states;
  if (!parent || !isContainer(parent) || !first) return false;
  if (predicted.state(childPath(path, first.path))) return false;
  // The interface of a library is defined in the library.
  if (states.some((state) => state.library && !state.outcomes)) return false;
  for (const state of states) predicted.put(whole(path, state));
  const decider = childPath(first.path, DECIDER);
  if (first.kind === "barrier" && !states.some((state) => state.path === decider)) {
    predicted.put(newDecider(childPath(path, decider)));
  }
  lead(predicted, parent, first);
  return true;
}

/** The state at its path, with the mandatory outcomes. */
function whole(parent: string, state: StateDocument): StateDocument {
  const missing = MANDATORY.filter(({ id }) => !outcomesOf(state).some((other) => other.id === id));
  const outcomes = [...missing, ...outcomesOf(state)].sort((one, other) => one.id - other.id);
  return { ...state, path: childPath(parent, state.path), outcomes };
}

function newDecider(path: string): StateDocument {
  const outcomes = [...MANDATORY, { id: 0, name: "success" }];
  return { path, name: "Decider", kind: "decider", outcomes };
}

/** Connects the outcomes of a barrier's child to the decider. */
export function lead(
  predicted: PredictedMachine,
  parent: StateDocument,
  child: StateDocument,
): void {
  const hasDecider = predicted.state(childPath(parent.path, DECIDER)) !== undefined;
  if (parent.kind !== "barrier" || !hasDecider || child.path === DECIDER) return;
  let state = parent;
  for (const { id: outcome } of outcomesOf(child)) {
    if (outcome < 0) continue;
    const id = nextTransition(state);
    const transition = {
      id,
      from_state: child.path,
      from_outcome: outcome,
      to_state: DECIDER,
    };
    state = withList(state, "transitions", placed(state.transitions, id, transition));
  }
  predicted.put(state);
}

export function remove(predicted: PredictedMachine, path: string, id: string): boolean {
  const parent = predicted.state(path);
  const child = predicted.state(childPath(path, id));
  if (!parent || !child || child.kind === "decider" || id === idOf(path)) return false;
  const at = (...ends: (string | null | undefined)[]) => ends.includes(id);
  const transitions = transitionsOf(parent).filter((t) => at(t.from_state, t.to_state));
  const flows = dataFlowsOf(parent).filter((flow) => at(flow.from_state, flow.to_state));
  const ids = (list: readonly { readonly id: number }[]) => list.map((each) => each.id);
  drop(predicted, path, ids(transitions), ids(flows));
  predicted.remove(child.path);
  return true;
}
