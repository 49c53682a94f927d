/** Groups of values of a state in a run: inputs, outputs and scoped variables, each valid up to an event. */

import type { Event } from "../../model/generated/protocol.ts";
import type { PortKind } from "../../model/machine.ts";
import type { StateStatus, Values } from "../../store/run/state_status.ts";
import type { Detailed } from "../parts/value/use_detail.ts";

export interface RunGroup {
  readonly kind: PortKind;
  readonly title: string;
  /** Null if the values were not stored, undefined while they are loading. */
  readonly values: Values | null | undefined;
  /** Reason why the values are unavailable. */
  readonly refusal: string | null;
  /** Event up to which the values are valid, and their origins are searched. Null for the newest event. */
  readonly until: number | null;
}

/** `entry` and `end` are the last entry and the last end with their values, used if the snapshot does not contain these. While
 * they load, they are the previous ones. */
export function runGroups(
  status: StateStatus,
  entry: Detailed,
  end: Detailed,
): readonly RunGroup[] {
  const { active, left, scoped, until, seen } = status;
  const inputs: RunGroup =
    status.inputs === undefined
      ? { kind: "input", title: "Inputs", ...ofEvent(entry, "inputs", until) }
      : { kind: "input", title: "Inputs", values: status.inputs, refusal: null, until };
  const title = active ? "Outputs at its last end" : "Outputs";
  const outputs: RunGroup =
    status.outputs === undefined
      ? { kind: "output", title, ...ofEvent(end, "outputs", until) }
      : { kind: "output", title, values: status.outputs, refusal: null, until };
  const variables: RunGroup = {
    kind: "scoped_variable",
    title: "Scoped variables",
    values: scoped,
    refusal: null,
    until: seen,
  };
  return [inputs, ...(left ? [outputs] : []), ...(scoped ? [variables] : [])];
}

function ofEvent(
  { detail, refusal }: Detailed,
  side: "inputs" | "outputs",
  until: number | null,
): Pick<RunGroup, "values" | "refusal" | "until"> {
  return { values: valuesIn(detail?.event, side), refusal, until: detail?.sequence ?? until };
}

function valuesIn(event: Event | undefined, side: "inputs" | "outputs"): Values | null | undefined {
  if (side === "inputs") return event?.type === "entered" ? (event.inputs ?? null) : undefined;
  return event?.type === "left" ? (event.outputs ?? null) : undefined;
}
