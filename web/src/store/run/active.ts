/** Active states of a run at the shown moment: from the latest status while live, otherwise from the picture of the moment. */

import { computed } from "@preact/signals-core";
import type {
  ActiveState,
  HeldBy,
  Hold,
  Moment,
  MomentState,
  Phase,
  Question,
  RunNow,
  Snapshot,
} from "../../model/generated/protocol.ts";
import { parentOf } from "../../model/path.ts";
import { perOwner } from "../../model/per_owner.ts";
import { AN_ANSWER } from "../../model/run_words.ts";
import type { Watch } from "../history/run.ts";

export interface Active {
  readonly path: string;
  readonly name: string;
  readonly phase: Phase;
  /** Time since its entry, as of the shown status. */
  readonly since_ms: number;
  /** Child of a concurrency state that starts its branch; empty on the root's branch. */
  readonly branch: string;
  /** Reason for waiting. */
  readonly detail: string | null;
  readonly held: readonly Hold[];
}

const activeSignal = perOwner((watch: Watch) => computed(() => found(watch)));

/** Active states, parents before their children. Reads signals. */
export function activeStates(watch: Watch): readonly Active[] {
  return activeSignal(watch).value;
}

function found(watch: Watch): readonly Active[] {
  if (watch.playhead.value === null) return ofNow(watch.now.value);
  const picture = watch.playheadSnapshot.value?.picture;
  return picture ? ofPicture(picture) : [];
}

/** Innermost active states, one per branch. A branch that is held before its first state is listed with its concurrency state. */
export function lanes(active: readonly Active[]): readonly Active[] {
  const inner = new Set(active.map(({ path }) => parentOf(path)));
  return active.flatMap((state) => {
    if (!inner.has(state.path) && state.held.length < 2) return [state];
    return state.held.map((hold) => heldBranch(state, hold));
  });
}

function heldBranch(state: Active, hold: Hold): Active {
  return { ...state, phase: "held", branch: hold.next ?? state.branch, held: [hold] };
}

/** Holder of a branch before its next state `path`; null if no branch is held there. */
export function heldBefore(active: readonly Active[], path: string): HeldBy | null {
  for (const { held } of active) {
    const hold = held.find(({ next }) => next === path);
    if (hold) return hold.by;
  }
  return null;
}

/** True if the breakpoint holds a branch. */
export function isHolding(active: readonly Active[], breakpoint: number): boolean {
  return active.some(({ held }) =>
    held.some(({ by }) => by.type === "breakpoint" && by.id === breakpoint),
  );
}

/** Current path of a lane: the active state, or the state before which the branch is held. */
export function placeOfLane({ path, held: [hold] }: Active): string {
  return hold?.next ?? path;
}

const NONE: readonly Active[] = [];

/** The last snapshot is valid while the run is active. After a crash, running scripts count as interrupted. */
function ofNow(now: RunNow | null): readonly Active[] {
  switch (now?.run.phase) {
    case "starting":
    case "live":
      return ofSnapshot(now.snapshot);
    case "crashed":
      return ofSnapshot(now.snapshot).map((state) =>
        state.phase === "running" ? { ...state, phase: "interrupted" } : state,
      );
    default:
      return NONE;
  }
}

function ofSnapshot(snapshot: Snapshot | null): readonly Active[] {
  if (!snapshot) return NONE;
  const asked = askers(snapshot.questions);
  return snapshot.active.map((state) => answered(state, asked));
}

/** A script with an open question counts as waiting. */
function answered(state: ActiveState | Active, asked: ReadonlySet<string>): Active {
  if (state.phase !== "running" || !asked.has(state.path)) return state;
  return { ...state, phase: "waiting", detail: AN_ANSWER };
}

function askers(questions: readonly Question[]): ReadonlySet<string> {
  return new Set(questions.map(({ path }) => path));
}

function ofPicture({ active, held, waiting, t_ns, questions }: Moment): readonly Active[] {
  const asked = askers(questions);
  const holds = new Map<string, Hold[]>();
  for (const { path, ...hold } of held) holds.set(path, [...(holds.get(path) ?? []), hold]);
  const branch = branches(active, holds);
  return active.map((state) => {
    const detail = waiting[state.path] ?? null;
    const here = holds.get(state.path) ?? [];
    const stands = {
      path: state.path,
      name: state.names.slice(state.names.lastIndexOf("/") + 1),
      phase: phaseOf(here, detail),
      since_ms: Math.max(0, (t_ns - state.since_ns) / 1e6),
      branch: branch(state.path),
      detail,
      held: here,
    };
    return answered(stands, asked);
  });
}

function phaseOf(held: readonly Hold[], detail: string | null): Phase {
  if (detail !== null) return "waiting";
  return held.length > 0 ? "held" : "running";
}

/** Derives the branches, which a picture does not contain: they begin where several children of a state are active or held. */
function branches(
  active: readonly MomentState[],
  holds: ReadonlyMap<string, readonly Hold[]>,
): (path: string) => string {
  const children = new Map<string, number>();
  for (const [path, { length }] of holds) children.set(path, length > 1 ? length : 0);
  for (const { path } of active) {
    const parent = parentOf(path);
    if (parent !== null) children.set(parent, (children.get(parent) ?? 0) + 1);
  }
  return (path) => {
    for (let at: string | null = path; at !== null; ) {
      const parent: string | null = parentOf(at);
      if (parent !== null && (children.get(parent) ?? 0) > 1) return at;
      at = parent;
    }
    return "";
  };
}
