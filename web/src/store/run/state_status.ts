/** Status of one state of a run at the shown moment: its visits, its phase, and the values at hand. */

import type { HeldBy, Moment, Outcome } from "../../model/generated/protocol.ts";
import { parentOf } from "../../model/path.ts";
import type { Watch } from "../history/run.ts";
import { visitsOf } from "../history/visits.ts";
import { type Active, activeStates, heldBefore } from "./active.ts";

/** A state's entry or end. */
export interface Turn {
  readonly sequence: number;
  readonly t_ns: number;
}

export interface VisitEnd extends Turn {
  readonly outcome: Outcome | null;
}

export type Values = Readonly<Record<string, unknown>>;

export interface StateStatus {
  /** Null if it is not active. */
  readonly active: Active | null;
  /** Holder of a branch before it; null if no branch is held there. */
  readonly next: HeldBy | null;
  readonly visits: number;
  /** Its last entry and end up to the moment; null if there was none. */
  readonly entered: Turn | null;
  readonly left: VisitEnd | null;
  /** Values in the picture of the moment; undefined if it has none. The events then contain them. */
  readonly inputs: Values | null | undefined;
  readonly outputs: Values | null | undefined;
  readonly scoped: Values | undefined;
  /** Last event that counts; null while live. */
  readonly until: number | null;
  /** Event at which `scoped` was recorded; null without a picture. */
  readonly seen: number | null;
}

/** Reads signals: an effect or computed value is updated when the status changes. */
export function stateStatusOf(watch: Watch, path: string): StateStatus {
  watch.journalVersion.value;
  const until = watch.playhead.value;
  const visits = visitsOf(watch);
  const entered = visits.lastVisit("entered", path, until);
  const left = visits.lastVisit("left", path, until);
  const picture = pictureOf(watch);
  const here = picture?.active.find((state) => state.path === path);
  const active = activeStates(watch);
  const isThis = here !== undefined && here.entered === entered?.sequence;
  return {
    active: active.find((state) => state.path === path) ?? null,
    next: heldBefore(active, path),
    visits: visits.count(path, until),
    entered,
    left,
    inputs: isThis ? here.inputs : undefined,
    outputs: left ? outputsIn(picture, path, left.sequence) : undefined,
    scoped: here?.scoped,
    until,
    seen: picture?.sequence ?? null,
  };
}

/** Picture with values of the shown moment; while live the latest one. */
export function pictureOf(watch: Watch): Moment | null {
  const picture = watch.playheadSnapshot.value?.picture ?? null;
  const playhead = watch.playhead.value;
  return playhead === null || picture?.sequence === playhead ? picture : null;
}

function outputsIn(picture: Moment | null, path: string, left: number): Values | null | undefined {
  const parent = parentOf(path);
  const container = picture?.active.find((state) => state.path === parent);
  return container?.ended.find((each) => each.path === path && each.sequence === left)?.outputs;
}
