/** Watched value at the shown moment. */

import { computed } from "@preact/signals-core";
import { useEffect, useMemo } from "react";
import type { LongValue } from "../../../model/generated/protocol.ts";
import { portsOf } from "../../../model/machine.ts";
import { originOf } from "../../../store/history/origin.ts";
import type { Watch } from "../../../store/history/run.ts";
import { visitsOf } from "../../../store/history/visits.ts";
import type { OpenTab, Page } from "../../../store/page/page.ts";
import { aheadOf } from "../../../store/run/ahead.ts";
import { pictureOf, stateStatusOf } from "../../../store/run/state_status.ts";
import { valueIn } from "../../../store/run/value_history.ts";
import type { Target } from "../../../store/run/watched_values.ts";
import { useThrottled } from "../../../ui/throttled.ts";
import { type Detailed, useDetail } from "./use_detail.ts";

const PACE_MS = 200;

export type ValueNow =
  | {
      readonly state: "there";
      readonly value: unknown;
      readonly sequence: number | null;
      /** Time of the run at which the value arrived ahead of its event. */
      readonly aheadAt_ns?: number;
    }
  /** The value exists, but is too long to be sent ahead of its event. */
  | { readonly state: "long"; readonly long: LongValue; readonly aheadAt_ns: number }
  /** Reason as text. */
  | { readonly state: "none"; readonly why: string }
  | { readonly state: "coming" };

const COMING: ValueNow = { state: "coming" };

/** Available value, or the event that contains it. */
type FoundValue = ValueNow | { readonly state: "event"; readonly sequence: number };

export function useValue(page: Page, tab: OpenTab, watch: Watch, target: Target): ValueNow {
  useEffect(() => watch.wantValues(), [watch]);
  const signal = useMemo(() => computed(() => find(tab, watch, target)), [tab, watch, target]);
  const found = useThrottled(signal, PACE_MS);
  const asked = useDetail(page.runs, watch.id, found.state === "event" ? found.sequence : null);
  return found.state === "event" ? fromDetail(asked, target) : found;
}

function fromDetail({ detail, refusal }: Detailed, target: Target): ValueNow {
  if (!detail) return refusal === null ? COMING : { state: "none", why: refusal };
  const value = valueIn(detail.event, target);
  if (value === undefined) return { state: "none", why: "it was not kept" };
  return { state: "there", value, sequence: detail.sequence };
}

function find(tab: OpenTab, watch: Watch, target: Target): FoundValue {
  const ahead = aheadOf(watch, target);
  if (ahead) {
    const { value, large, sequence, t_ns: aheadAt_ns } = ahead;
    if (value === null && large) return { state: "long", long: large, aheadAt_ns };
    return { state: "there", value, sequence, aheadAt_ns };
  }
  const { kind, path, name } = target;
  if (kind === "global") {
    const picture = pictureOf(watch);
    if (!picture) return COMING;
    const isThere = Object.hasOwn(picture.globals, name);
    if (!isThere) return { state: "none", why: "no such global variable at this moment" };
    return { state: "there", value: picture.globals[name], sequence: null };
  }
  const status = stateStatusOf(watch, path);
  if (kind === "scoped_variable") {
    if (!status.scoped) return { state: "none", why: "its state is not active at this moment" };
    return {
      state: "there",
      value: status.scoped[name],
      sequence: writtenAt(tab, watch, target),
    };
  }
  const turn = kind === "input" ? status.entered : status.left;
  const values = kind === "input" ? status.inputs : status.outputs;
  if (!turn) return { state: "none", why: kind === "input" ? "not entered yet" : "not ended yet" };
  if (values === null) return { state: "none", why: "it was not kept" };
  if (values === undefined) return { state: "event", sequence: turn.sequence };
  if (!Object.hasOwn(values, name)) return { state: "none", why: "no value was given" };
  return { state: "there", value: values[name], sequence: turn.sequence };
}

function writtenAt({ session }: OpenTab, watch: Watch, { path, name }: Target): number | null {
  const state = session.machine.state(path);
  const port = state && portsOf(state, "scoped_variable").find((each) => each.name === name);
  if (!port) return null;
  const ref = { kind: "scoped_variable", path, id: port.id } as const;
  return originOf(session.machine, visitsOf(watch), ref, watch.playhead.value)?.sequence ?? null;
}
