/** Read interface of a machine for the whole page, independent of its source and its edits. */

import type {
  DataFlowDocument,
  HeaderDocument,
  OutcomeDocument,
  PortDocument,
  StateDocument,
  TransitionDocument,
} from "./generated/protocol.ts";

/** States by path. State documents are immutable: a changed state is another object. */
export interface Machine {
  /** Changes whenever anything in the machine changes. */
  readonly version: number;
  /** Path of the root state, which is its id. */
  readonly root: string;
  readonly header: HeaderDocument;
  /** The state, also inside a library with loaded content; undefined if it does not exist. */
  state(path: string): StateDocument | undefined;
  /** Paths of the children by ascending id. For a library state the root of its content, once that is loaded. */
  children(path: string): readonly string[];
  /** True if the state belongs to the content of a library, which is shown but cannot be edited. */
  isInLibrary(path: string): boolean;
  /** Paths of all states outside libraries, parents before children. */
  paths(): Iterable<string>;
  /** Paths of the states that changed since a version; null if all may have changed. Not needed by immutable machines. */
  touchedSince?(version: number): ReadonlySet<string> | null;
}

/** Ids of the outcomes that every state has. */
export const ABORTED = -1;
export const PREEMPTED = -2;

/** Id of every decider. */
export const DECIDER_ID = "unique_decider_state_id";

const NO_OUTCOMES: readonly OutcomeDocument[] = [];
const NO_PORTS: readonly PortDocument[] = [];
const NO_TRANSITIONS: readonly TransitionDocument[] = [];
const NO_DATA_FLOWS: readonly DataFlowDocument[] = [];

export type PortKind = "input" | "output" | "scoped_variable";

export function outcomesOf(state: StateDocument): readonly OutcomeDocument[] {
  return state.outcomes ?? NO_OUTCOMES;
}

export function transitionsOf(state: StateDocument): readonly TransitionDocument[] {
  return state.transitions ?? NO_TRANSITIONS;
}

export function dataFlowsOf(state: StateDocument): readonly DataFlowDocument[] {
  return state.data_flows ?? NO_DATA_FLOWS;
}

export function portsOf(state: StateDocument, kind: PortKind): readonly PortDocument[] {
  switch (kind) {
    case "input":
      return state.inputs ?? NO_PORTS;
    case "output":
      return state.outputs ?? NO_PORTS;
    case "scoped_variable":
      return state.scoped_variables ?? NO_PORTS;
  }
}

/** True if a state can contain others. Libraries show their content but accept no states. */
export function isContainer(state: StateDocument): boolean {
  return state.kind === "hierarchy" || isConcurrent(state);
}

export function isConcurrent(state: StateDocument): boolean {
  return state.kind === "barrier" || state.kind === "preemptive";
}

/** The transition from the income of a container, which leads to its first state. */
export function startOf(state: StateDocument): TransitionDocument | undefined {
  return transitionsOf(state).find((transition) => transition.from_state == null);
}

/** Names from the root to the state. */
export function namesTo(machine: Machine, path: string): readonly string[] {
  const names: string[] = [];
  for (let end = 0; end >= 0; ) {
    end = path.indexOf("/", end + 1);
    const at = end < 0 ? path : path.slice(0, end);
    names.push(machine.state(at)?.name ?? at);
  }
  return names;
}
