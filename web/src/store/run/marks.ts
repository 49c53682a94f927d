/** Marks of a run on the canvas at the shown moment: activity of each state, recent ends, unacknowledged failures, and the next
 * transition of held branches. */

import { computed, type ReadonlySignal } from "@preact/signals-core";
import { type ElementKey, keyOf } from "../../model/element.ts";
import type { TransitionDocument } from "../../model/generated/protocol.ts";
import {
  isConcurrent,
  type Machine,
  PREEMPTED,
  startOf,
  transitionsOf,
} from "../../model/machine.ts";
import { idOf, parentOf } from "../../model/path.ts";
import { perOwner } from "../../model/per_owner.ts";
import type { MachineSession } from "../document/machine_session.ts";
import { countsUntil } from "../history/counts_until.ts";
import { isEnd, type RunFailure } from "../history/failures.ts";
import { RecentPath, type TakenTransition, type TransitionGoal } from "../history/recent_path.ts";
import type { Watch } from "../history/run.ts";
import { openFailures } from "./acknowledged.ts";
import { type Active, activeStates, lanes } from "./active.ts";

/** `next`: a held branch will enter it. `inside`: only states inside it are marked. */
export type MarkPhase =
  | "running"
  | "waiting"
  | "held"
  | "failed"
  | "preempted"
  | "next"
  | "trail"
  | "inside";

/** Status of a state in a run. */
export interface RunMark {
  readonly phase: MarkPhase;
  /** Most urgent phase of the state and all states inside it. */
  readonly mostUrgent: MarkPhase;
  /** Most urgent phase other than `failed`, so that failures hide neither activity nor states that need a person. */
  readonly mostUrgentActive: MarkPhase;
  /** True if it is active and no state inside it is. */
  readonly isLeaf: boolean;
  /** Number of active branches inside it. */
  readonly lanes: number;
  /** Number of states of its branch that ended since it did; 0 if it has not ended. */
  readonly age: number;
  /** Time since its entry, as of the snapshot; null if it is not active. */
  readonly since_ms: number | null;
  /** True if it ended because it was preempted. */
  readonly preempted: boolean;
  /** True if it failed and nobody has acknowledged it. */
  readonly failed: boolean;
  /** Details of its phase: the reason for waiting. */
  readonly detail: string | null;
}

/** A transition that was taken `age` steps ago, or that is the next one of a held branch. */
export interface LineMarkOfRun {
  readonly isNext: boolean;
  readonly age: number;
  /** Sequence number of the event that took it. */
  readonly sequence: number;
}

interface RunMarks {
  readonly states: ReadonlyMap<string, RunMark>;
  readonly lines: ReadonlyMap<ElementKey, LineMarkOfRun>;
  /** Errors of the states that failed. */
  readonly errors: ReadonlyMap<string, string>;
  /** Number of entries of a state. */
  readonly visits: (path: string) => number;
}

/** In ascending urgency. */
const URGENCY: readonly MarkPhase[] = [
  "inside",
  "trail",
  "preempted",
  "next",
  "running",
  "waiting",
  "held",
  "failed",
];

const marksOf = perOwner((watch: Watch) =>
  perOwner((session: MachineSession) => following(watch, session)),
);

/** Marks of a run on a machine. Reads signals. */
export function runMarks(watch: Watch, session: MachineSession): RunMarks {
  return marksOf(watch)(session).value;
}

function following(watch: Watch, session: MachineSession): ReadonlySignal<RunMarks> {
  const isConcurrentAt = (path: string) => {
    const state = session.machine.state(path);
    return state !== undefined && isConcurrent(state);
  };
  const newRecentPath = () => new RecentPath(isConcurrentAt);
  let live = newRecentPath();
  let journal = watch.journal;
  let version = session.machine.version;
  return computed(() => {
    watch.journalVersion.value;
    session.version.value;
    const isOther = version !== session.machine.version || journal !== watch.journal;
    if (isOther) live = newRecentPath();
    version = session.machine.version;
    journal = watch.journal;
    const until = shownUntil(watch);
    const recentPath = until === null ? live : newRecentPath();
    const window = until === null ? journal : watch.window;
    const index = until === null ? journal.length : window.indexOf(until + 1);
    recentPath.follow(window, index);
    const failed = failedStates(openFailures(watch).value, until ?? Number.POSITIVE_INFINITY);
    return {
      states: stateMarks(activeStates(watch), recentPath, new Set(failed.keys())),
      errors: failed,
      lines: lineMarks(activeStates(watch), recentPath, session.machine),
      visits: (path) => {
        // The part around the moment, or the counts before it, may still be loading.
        if (!window.hasCounts || (until !== null && !window.covers(until))) return 0;
        if (until === null) return window.counts.get(path)?.entries ?? 0;
        return countsUntil(window, index).entries(path);
      },
    };
  });
}

/** Last event that is shown; null while live. */
function shownUntil(watch: Watch): number | null {
  if (watch.playhead.value === null) return null;
  return watch.playheadSnapshot.value?.picture.sequence ?? watch.playhead.value;
}

/** States that failed up to an event, from the origin of the error to where it was handled, with their errors. */
export function failedStates(
  open: readonly RunFailure[],
  until: number,
): ReadonlyMap<string, string> {
  const found = new Map<string, string>();
  for (const failure of open) {
    const { path, reach, first, text } = failure;
    if (!isEnd(failure) || first > until) continue;
    for (let at: string | null = path; at !== null; at = at === reach ? null : parentOf(at)) {
      found.set(at, text);
    }
  }
  return found;
}

type RunMarkDraft = { -readonly [K in keyof RunMark]: RunMark[K] };

/** Marks of states by path: their own, and for outer states the urgency of inner ones. */
export function stateMarks(
  active: readonly Active[],
  recentPath: RecentPath,
  failed: ReadonlySet<string>,
): ReadonlyMap<string, RunMark> {
  const marks = new Map<string, RunMarkDraft>();
  const mark = (path: string, phase: MarkPhase): RunMarkDraft => {
    const found = marks.get(path) ?? newMark();
    marks.set(path, found);
    if (isMoreUrgent(phase, found.phase)) found.phase = phase;
    return found;
  };
  for (const { path, age, outcome } of recentPath.past()) {
    if (path !== null)
      Object.assign(mark(path, "trail"), { age, preempted: outcome === PREEMPTED });
  }
  for (const path of failed) mark(path, "failed").failed = true;
  activeMarks(active, mark);
  for (const [path, { phase, failed: isFailed }] of [...marks]) {
    spread(path, phase, "mostUrgent", mark);
    if (phase !== "failed") spread(path, phase, "mostUrgentActive", mark);
    if (isFailed) spread(path, "failed", "mostUrgent", mark);
  }
  return marks;
}

/** Marks active states. They override all earlier marks. */
function activeMarks(
  active: readonly Active[],
  mark: (path: string, phase: MarkPhase) => RunMarkDraft,
) {
  const inner = new Set(active.map(({ path }) => parentOf(path)));
  for (const state of active) {
    const found = mark(state.path, "inside");
    const phase = state.phase === "interrupted" ? "waiting" : state.phase;
    Object.assign(found, {
      phase,
      isLeaf: !inner.has(state.path),
      age: 0,
      preempted: false,
      since_ms: state.since_ms,
      detail: state.detail,
    });
    for (const { next } of state.held) if (next !== null) mark(next, "next");
  }
  for (const path of stillAround(active)) mark(path, "inside").phase = "waiting";
  for (const { path } of lanes(active)) {
    for (let at = parentOf(path); at !== null; at = parentOf(at)) mark(at, "inside").lanes += 1;
  }
}

/** States around waiting branches in which no branch is busy. They count as waiting, too. */
function stillAround(active: readonly Active[]): readonly string[] {
  const busy = new Set<string>();
  const inner = new Set(active.map(({ path }) => parentOf(path)));
  for (const { path, phase } of lanes(active)) {
    if (phase === "waiting" || phase === "interrupted") continue;
    for (let at: string | null = path; at !== null; at = parentOf(at)) busy.add(at);
  }
  return active
    .filter(({ path, phase }) => phase === "running" && inner.has(path) && !busy.has(path))
    .map(({ path }) => path);
}

function newMark(): RunMarkDraft {
  return {
    phase: "inside",
    mostUrgent: "inside",
    mostUrgentActive: "inside",
    isLeaf: false,
    lanes: 0,
    age: 0,
    since_ms: null,
    preempted: false,
    failed: false,
    detail: null,
  };
}

/** Raises the urgency of a state and the states around it. Trails do not affect outer states. */
function spread(
  path: string,
  phase: MarkPhase,
  what: "mostUrgent" | "mostUrgentActive",
  mark: (path: string, phase: MarkPhase) => RunMarkDraft,
) {
  for (let at: string | null = path; at !== null; at = parentOf(at)) {
    const found = mark(at, "inside");
    const isRaised = isMoreUrgent(phase, found[what]);
    if (isRaised) found[what] = phase;
    else if (at !== path) return;
    if (phase === "trail") return;
  }
}

export function isMoreUrgent(one: MarkPhase, other: MarkPhase): boolean {
  return URGENCY.indexOf(one) > URGENCY.indexOf(other);
}

function lineMarks(
  active: readonly Active[],
  recentPath: RecentPath,
  machine: Machine,
): ReadonlyMap<ElementKey, LineMarkOfRun> {
  const marks = new Map<ElementKey, LineMarkOfRun>();
  for (const { taken, goal, age, sequence } of recentPath.past()) {
    const key = taken && transitionOf(machine, taken, goal);
    if (key) marks.set(key, { isNext: false, age, sequence });
  }
  for (const { path, held } of active) {
    for (const { next } of held) {
      const from = recentPath.from(path);
      const key = from && transitionOf(machine, from, next);
      if (key) marks.set(key, { isNext: true, age: 0, sequence: 0 });
    }
  }
  return marks;
}

/** Key of the transition; null if the machine has no such transition, or if it has another target. */
export function transitionOf(
  machine: Machine,
  { container, from, outcome }: TakenTransition,
  goal: TransitionGoal | null = null,
): ElementKey | null {
  const state = machine.state(container);
  if (!state) return null;
  const found =
    from === null
      ? startOf(state)
      : transitionsOf(state).find(
          (each) => each.from_state === idOf(from) && each.from_outcome === outcome,
        );
  if (!found || (goal !== null && !leads(found, goal))) return null;
  return keyOf({ kind: "transition", path: container, id: found.id });
}

function leads({ to_state, to_outcome }: TransitionDocument, goal: TransitionGoal): boolean {
  return typeof goal === "string"
    ? to_outcome == null && to_state === idOf(goal)
    : to_outcome === goal;
}
