/** A machine as everything in the page reads it. Who changes it, and how it came here, is not known here. */

import type {
  DataFlowDocument,
  HeaderDocument,
  OutcomeDocument,
  PortDocument,
  StateDocument,
  TransitionDocument,
} from "./generated/protocol.ts";

/** States by path. State documents are never changed in place: another object means another state. */
export interface Machine {
  /** Another number whenever anything is different. */
  readonly version: number;
  /** The path of the root state, which is its id. */
  readonly root: string;
  readonly header: HeaderDocument;
  /** The state, also one inside a library whose content is here; undefined if there is none. */
  state(path: string): StateDocument | undefined;
  /** Paths of the children by rising id; of a library state the root of its content, once that is here. */
  children(path: string): readonly string[];
  /** Whether the state belongs to the content of a library, which is shown and never edited. */
  isInLibrary(path: string): boolean;
  /** Paths of all states but those inside libraries, a state before its children. */
  paths(): Iterable<string>;
  /** Paths of the states that are different since a version; null: all may be. Machines that do not change need no answer. */
  touchedSince?(version: number): ReadonlySet<string> | null;
}

/** Outcome ids that every state has. */
export const ABORTED = -1;
export const PREEMPTED = -2;

/** The id that every decider has. */
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

/** Whether states can stand inside: libraries show their content and take nothing. */
export function isContainer(state: StateDocument): boolean {
  return state.kind === "hierarchy" || isConcurrent(state);
}

export function isConcurrent(state: StateDocument): boolean {
  return state.kind === "barrier" || state.kind === "preemptive";
}

/** The transition from the income of a container: where it starts. */
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
