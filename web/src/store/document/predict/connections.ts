/** Predicts edits of transitions and data flows. */

import type {
  DataFlowDocument,
  Edit,
  Goal,
  OutcomeOf,
  StateDocument,
  TransitionDocument,
} from "../../../model/generated/protocol.ts";
import { dataFlowsOf, isContainer, transitionsOf } from "../../../model/machine.ts";
import { idOf } from "../../../model/path.ts";
import { placed, withList } from "../lists.ts";
import { update } from "./own.ts";
import { placeKey, withoutPlaces } from "./places.ts";
import type { PredictedMachine } from "./predicted_machine.ts";

/** Predicts the edit; false if it is of another kind, or if only the server knows its effect. */
export function connections(predicted: PredictedMachine, edit: Edit): boolean {
  switch (edit.edit) {
    case "add_transition":
      return addTransition(predicted, edit.path, edit.transition, (id, state) =>
        withGoal(withOrigin({ id }, edit.from), edit.to, state),
      );
    case "set_transition_origin":
      return changeTransition(predicted, edit.path, edit.transition, (earlier) =>
        withOrigin(earlier, edit.from),
      );
    case "set_transition_target":
      return changeTransition(predicted, edit.path, edit.transition, (earlier, state) =>
        withGoal(earlier, edit.to, state),
      );
    case "remove_transition":
      return drop(predicted, edit.path, [edit.transition], []);
    case "set_start":
      return setStart(predicted, edit.path, edit.to);
    default:
      return dataFlow(predicted, edit);
  }
}

/** Removes connections of a container, with their positions; false if one of them does not exist. */
export function drop(
  predicted: PredictedMachine,
  path: string,
  transitions: readonly number[],
  dataFlows: readonly number[],
): boolean {
  const state = predicted.state(path);
  if (!state) return false;
  if (transitions.length + dataFlows.length === 0) return true;
  const left = transitionsOf(state).filter(({ id }) => !transitions.includes(id));
  const leftFlows = dataFlowsOf(state).filter(({ id }) => !dataFlows.includes(id));
  const gone = transitionsOf(state).length + dataFlowsOf(state).length;
  const keys = [
    ...transitions.map((id) => placeKey("transition", id)),
    ...dataFlows.map((id) => placeKey("data_flow", id)),
  ];
  const without = withList(withList(state, "transitions", left), "data_flows", leftFlows);
  predicted.put(withoutPlaces(without, keys));
  return gone - left.length - leftFlows.length === transitions.length + dataFlows.length;
}

/** Id of the next transition of a container. */
export function nextTransition(state: StateDocument): number {
  return Math.max(0, ...transitionsOf(state).map(({ id }) => id)) + 1;
}

/** The transition with another target in the container. */
function withGoal(
  transition: TransitionDocument,
  to: Goal,
  container: StateDocument,
): TransitionDocument {
  const { to_state: _, to_outcome: __, ...rest } = transition;
  if ("state" in to) return { ...rest, to_state: to.state };
  return { ...rest, to_state: idOf(container.path), to_outcome: to.outcome };
}

function withOrigin(transition: TransitionDocument, from: OutcomeOf | null): TransitionDocument {
  const { from_state: _, from_outcome: __, ...rest } = transition;
  return from ? { ...rest, from_state: from.state, from_outcome: from.outcome } : rest;
}

function addTransition(
  predicted: PredictedMachine,
  path: string,
  id: number,
  make: (id: number, state: StateDocument) => TransitionDocument,
): boolean {
  const state = predicted.state(path);
  if (!state || !isContainer(state)) return false;
  if (transitionsOf(state).some((other) => other.id === id)) return false;
  return update(predicted, path, () =>
    withList(state, "transitions", placed(state.transitions, id, make(id, state))),
  );
}

function changeTransition(
  predicted: PredictedMachine,
  path: string,
  id: number,
  next: (earlier: TransitionDocument, state: StateDocument) => TransitionDocument,
): boolean {
  const state = predicted.state(path);
  const earlier = state?.transitions?.find((other) => other.id === id);
  if (!state || !earlier) return false;
  const transitions = placed(state.transitions, id, next(earlier, state));
  predicted.put(withList(state, "transitions", transitions));
  return true;
}

function setStart(predicted: PredictedMachine, path: string, to: Goal | null): boolean {
  const state = predicted.state(path);
  if (!state || !isContainer(state)) return false;
  const isStart = (transition: TransitionDocument) =>
    transition.from_state == null && transition.from_outcome == null;
  const [first, ...others] = transitionsOf(state).filter(isStart);
  const gone = (to || !first ? others : [first, ...others]).map(({ id }) => id);
  if (to) {
    const start = withGoal(first ?? { id: nextTransition(state) }, to, state);
    predicted.put(withList(state, "transitions", placed(state.transitions, start.id, start)));
  }
  return drop(predicted, path, gone, []);
}

function dataFlow(predicted: PredictedMachine, edit: Edit): boolean {
  switch (edit.edit) {
    case "add_data_flow":
      return setFlow(predicted, edit.path, edit.data_flow, (earlier) => {
        if (earlier) return undefined;
        const { from, to } = edit;
        return { id: edit.data_flow, ...source(from), to_state: to.state, to_port: to.port };
      });
    case "set_data_flow_source":
      return setFlow(
        predicted,
        edit.path,
        edit.data_flow,
        (earlier) => earlier && { ...earlier, ...source(edit.from) },
      );
    case "set_data_flow_target":
      return setFlow(
        predicted,
        edit.path,
        edit.data_flow,
        (earlier) => earlier && { ...earlier, to_state: edit.to.state, to_port: edit.to.port },
      );
    case "remove_data_flow":
      return drop(predicted, edit.path, [], [edit.data_flow]);
    default:
      return false;
  }
}

function source({ state, port }: { readonly state: string; readonly port: number }) {
  return { from_state: state, from_port: port };
}

/** `next` returns undefined if the edit is impossible. */
function setFlow(
  predicted: PredictedMachine,
  path: string,
  id: number,
  next: (earlier: DataFlowDocument | undefined) => DataFlowDocument | undefined,
): boolean {
  const state = predicted.state(path);
  if (!state || !isContainer(state)) return false;
  const flow = next(dataFlowsOf(state).find((other) => other.id === id));
  if (!flow) return false;
  predicted.put(withList(state, "data_flows", placed(state.data_flows, id, flow)));
  return true;
}
