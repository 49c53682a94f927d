/** Which transitions are legal, and those that lead over several levels through the outcomes between. */

import type { ElementRef } from "../model/element.ts";
import { nameOf } from "../model/ends.ts";
import type {
  Edit,
  Goal,
  OutcomeOf,
  StateDocument,
  TransitionDocument,
} from "../model/generated/protocol.ts";
import {
  DECIDER_ID,
  isConcurrent,
  isContainer,
  type Machine,
  outcomesOf,
  startOf,
  transitionsOf,
} from "../model/machine.ts";
import { freshName, freshNumber } from "../model/names.ts";
import { childPath, commonPath, idOf, isWithin, parentOf } from "../model/path.ts";
import { containerAt } from "./legal.ts";
import { isRefused, type Refused, refused } from "./plan.ts";

/** A transition that might be: in which container, from where to where. */
interface PossibleTransition {
  readonly container: string;
  /** Null: from the income of the container. */
  readonly from: OutcomeOf | null;
  readonly to: Goal;
}

interface OutcomeRef {
  readonly kind: "outcome";
  readonly path: string;
  readonly id: number;
}

function isOutcome(element: ElementRef): element is ElementRef & OutcomeRef {
  return element.kind === "outcome";
}

/** The transition between two elements of one level; null if they are on different ones, or if it would run backwards. */
export function lineBetween(from: ElementRef, to: ElementRef): PossibleTransition | null {
  const container = originContainer(from);
  if (container === null) return null;
  const goal = goalIn(container, to);
  if (!goal) return null;
  const origin = from.kind === "outcome" ? { state: idOf(from.path), outcome: from.id } : null;
  return { container, from: origin, to: goal };
}

/** The container inside which something begins here. */
function originContainer(from: ElementRef): string | null {
  if (from.kind === "income") return from.path;
  return from.kind === "outcome" ? parentOf(from.path) : null;
}

function goalIn(container: string, to: ElementRef): Goal | null {
  if (to.kind === "outcome") return to.path === container ? { outcome: to.id } : null;
  if (to.kind !== "income" && to.kind !== "state") return null;
  return parentOf(to.path) === container ? { state: idOf(to.path) } : null;
}

/** Reason why the transition breaks a rule; null if it is valid. `ignored` is a transition that it replaces. */
export function lineRefused(
  machine: Machine,
  line: PossibleTransition,
  ignored?: number,
): Refused | null {
  const container = containerAt(machine, line.container);
  if (isRefused(container)) return container;
  return (
    endRefused(machine, line) ??
    (line.from ? twinRefused(machine, container, line, ignored) : null) ??
    kindRefused(container, line)
  );
}

function endRefused(machine: Machine, { container, from, to }: PossibleTransition): Refused | null {
  for (const id of [from?.state, "state" in to ? to.state : undefined]) {
    const path = id === undefined ? null : childPath(container, id);
    if (path !== null && !machine.state(path)) {
      return refused(`The state ${path} no longer exists: someone may have removed it.`);
    }
  }
  return null;
}

function twinRefused(
  machine: Machine,
  container: StateDocument,
  { container: path, from }: PossibleTransition,
  ignored: number | undefined,
): Refused | null {
  const twin = from && beginning(container, from, ignored);
  if (!twin) return null;
  const at = childPath(path, from.state);
  const outcome = nameOf(machine, { kind: "outcome", path: at, id: from.outcome });
  const goal = goalName(machine, path, twin);
  return refused(
    `${machine.state(at)?.name}.${outcome} already leads to ${goal}: drag the end of that transition elsewhere, or delete it first.`,
  );
}

function goalName(machine: Machine, container: string, transition: TransitionDocument): string {
  const { to_state, to_outcome } = transition;
  return to_outcome == null
    ? nameOf(machine, { kind: "state", path: childPath(container, to_state ?? "") })
    : nameOf(machine, { kind: "outcome", path: container, id: to_outcome });
}

/** The transition that begins at an outcome of a child. */
export function beginning(
  container: StateDocument,
  from: OutcomeOf,
  ignored?: number,
): TransitionDocument | undefined {
  return transitionsOf(container).find(
    ({ id, from_state, from_outcome }) =>
      id !== ignored && from_state === from.state && from_outcome === from.outcome,
  );
}

/** Rules of concurrency states. */
export function kindRefused(
  container: StateDocument,
  { from, to }: Pick<PossibleTransition, "from" | "to">,
): Refused | null {
  const { name, kind } = container;
  if (!from) {
    return isConcurrent(container)
      ? refused(`${name} runs all its states at once: it has no start.`)
      : null;
  }
  const toState = "state" in to;
  if (kind === "preemptive" && toState) {
    return refused(
      `${name} runs all its states at once: lead to an outcome of ${name} instead of another state.`,
    );
  }
  if (kind !== "barrier") return null;
  if (from.state === DECIDER_ID) {
    return toState ? refused(`The decider ends ${name}: lead to an outcome of ${name}.`) : null;
  }
  const legal = toState ? to.state === DECIDER_ID : to.outcome < 0 && from.outcome < 0;
  return legal
    ? null
    : refused(
        `${name} waits for all its states: lead to its decider, or from aborted and preempted to those of ${name}.`,
      );
}

/** The edit that adds the transition. An existing start leads here from now on. */
export function lineEdit(machine: Machine, line: PossibleTransition): Edit {
  const { container: path, from, to } = line;
  const container = machine.state(path);
  if (!from) return { edit: "set_start", path, to };
  const transition = freshNumber(container ? transitionsOf(container) : []);
  return { edit: "add_transition", path, transition, from, to };
}

/** Edits for a transition from one level to another; outcomes between are made, starts between set where there are none. */
export function climb(
  machine: Machine,
  from: ElementRef,
  to: ElementRef,
  ignored?: { readonly path: string; readonly id: number },
): Edit[] | Refused {
  const begin = originContainer(from);
  const end = to.kind === "outcome" ? to.path : parentOf(to.path);
  const meeting = begin !== null && end !== null ? commonPath([begin, end]) : null;
  if (begin === null || end === null || meeting === null) return backwards();
  if (from.kind === "outcome" && isWithin(end, from.path)) {
    return refused("A state cannot lead into itself. Start at its income to set its start state.");
  }
  const up = ascend(machine, from, begin, meeting, ignored);
  if (isRefused(up)) return up;
  const down = descend(machine, meeting, end, to);
  if (isRefused(down)) return down;
  const line = lineBetween(up.from, down.to);
  if (!line) return backwards();
  const isNew = up.from !== from;
  const at = ignored?.path === line.container ? ignored.id : undefined;
  const bad = isNew ? newLineRefused(machine, line) : lineRefused(machine, line, at);
  return bad ?? [...up.edits, ...down.edits, lineEdit(machine, line)];
}

function backwards(): Refused {
  return refused(
    "A transition leads from an outcome of a state to another state, or to an outcome of its container.",
  );
}

/** The line begins at an outcome that nothing leads from yet. */
function newLineRefused(machine: Machine, line: PossibleTransition): Refused | null {
  const container = containerAt(machine, line.container);
  return isRefused(container) ? container : kindRefused(container, line);
}

interface Up {
  readonly edits: Edit[];
  /** The outcome at which the highest transition begins. */
  readonly from: ElementRef;
}

function ascend(
  machine: Machine,
  from: ElementRef,
  begin: string,
  meeting: string,
  ignored: { readonly path: string; readonly id: number } | undefined,
): Up | Refused {
  const edits: Edit[] = [];
  let source = from;
  for (let level = begin; level !== meeting; level = parentOf(level) ?? meeting) {
    if (!isOutcome(source)) {
      return refused("A start leads to a state inside its own container.");
    }
    const passage = passageOut(machine, level, source);
    if (isRefused(passage)) return passage;
    const line = lineBetween(source, passage.outcome);
    if (!line) return backwards();
    const at = ignored?.path === level ? ignored.id : undefined;
    const bad = source === from ? lineRefused(machine, line, at) : newLineRefused(machine, line);
    if (bad) return bad;
    edits.push(...passage.edits, lineEdit(machine, line));
    source = passage.outcome;
  }
  return { edits, from: source };
}

interface Passage {
  readonly edits: Edit[];
  readonly outcome: OutcomeRef;
}

/** An outcome of the container that leads nowhere yet and has the name of the source; made if there is none. */
function passageOut(machine: Machine, path: string, source: OutcomeRef): Passage | Refused {
  const container = containerAt(machine, path);
  if (isRefused(container)) return container;
  const parent = parentOf(path);
  const around = parent === null ? undefined : machine.state(parent);
  const wanted = outcomeName(machine, source);
  const isFree = (outcome: number) => !around || !beginning(around, { state: idOf(path), outcome });
  const known = outcomesOf(container).find(
    ({ id, name }) => (source.id < 0 ? id === source.id : name === wanted) && isFree(id),
  );
  if (known) return { edits: [], outcome: outcomeAt(path, known.id) };
  const name = freshName(
    wanted,
    outcomesOf(container).map((outcome) => outcome.name),
  );
  const outcome = freshNumber(outcomesOf(container));
  return {
    edits: [{ edit: "add_outcome", path, outcome, name }],
    outcome: outcomeAt(path, outcome),
  };
}

/** The name of the outcome where the line began: those between are not there yet. */
function outcomeName(machine: Machine, source: OutcomeRef): string {
  const state = machine.state(source.path);
  const known = state && outcomesOf(state).find(({ id }) => id === source.id);
  return known?.name ?? "success";
}

function outcomeAt(path: string, id: number): OutcomeRef {
  return { kind: "outcome", path, id };
}

interface Down {
  readonly edits: Edit[];
  /** End of the outermost transition. */
  readonly to: ElementRef;
}

/** The way in leads through starts only: those that are there must lead to the target. */
function descend(machine: Machine, meeting: string, end: string, to: ElementRef): Down | Refused {
  if (end === meeting) return { edits: [], to };
  if (to.kind === "outcome") {
    return refused(
      `Only states inside ${machine.state(to.path)?.name} can lead to its outcomes: start inside it.`,
    );
  }
  const edits: Edit[] = [];
  let inner = to.path;
  for (let level = end; level !== meeting; level = parentOf(level) ?? meeting) {
    const start = startAt(machine, level, inner);
    if (isRefused(start)) return start;
    edits.push(...start);
    inner = level;
  }
  return { edits, to: { kind: "income", path: inner } };
}

function startAt(machine: Machine, path: string, child: string): Edit[] | Refused {
  const container = containerAt(machine, path);
  if (isRefused(container)) return container;
  const [outer, inner] = [container.name, machine.state(child)?.name ?? idOf(child)];
  if (isConcurrent(container)) {
    return refused(`${outer} runs all its states at once: lead to ${outer} itself.`);
  }
  const start = startOf(container);
  if (start?.to_outcome == null && start?.to_state === idOf(child)) return [];
  if (start) {
    return refused(
      `${outer} is entered only at its start: make ${inner} its start, or lead to ${outer} itself.`,
    );
  }
  return [{ edit: "set_start", path, to: { state: idOf(child) } }];
}

/** The outcome at which a new transition from the state would begin: the first from 0 on that leads nowhere. */
export function freeOutcome(machine: Machine, path: string): number | null {
  const state = machine.state(path);
  const parent = parentOf(path);
  const around = parent === null ? undefined : machine.state(parent);
  if (!state || !around || !isContainer(around)) return null;
  const free = outcomesOf(state).find(
    ({ id }) => id >= 0 && !beginning(around, { state: idOf(path), outcome: id }),
  );
  return free?.id ?? null;
}
