/** How one state stands in a run at the moment that is shown: its visits, its phase, and what is at hand of its values. */

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
  /** Null while it is not active. */
  readonly active: Active | null;
  /** By what a branch is held before it; null while none is. */
  readonly next: HeldBy | null;
  readonly visits: number;
  /** Its last entry and its last end up to the moment; null if there was none. */
  readonly entered: Turn | null;
  readonly left: VisitEnd | null;
  /** Values that the moment's picture has; undefined where it has none: then the events tell. */
  readonly inputs: Values | null | undefined;
  readonly outputs: Values | null | undefined;
  readonly scoped: Values | undefined;
  /** The event up to which everything counts; null while live. */
  readonly until: number | null;
  /** The event after which `scoped` was so; null without a picture. */
  readonly seen: number | null;
}

/** Reads signals: an effect or computed value is told when it may be another. */
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

/** The picture with values of the moment that is shown; while live the newest one. */
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
