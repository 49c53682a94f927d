/** Origin of a value in a run: when it reached its port and which state provided it. Derived from the data flows of the machine and
 * the order of events. */

import { type ConnectionEnds, type DataPort, flowEnds, isPort } from "../../model/ends.ts";
import { dataFlowsOf, type Machine } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";
import type { Visits } from "./visits.ts";

export interface Origin {
  /** Event with which the value reached the port. */
  readonly sequence: number;
  /** State that provided it; for a default value the state itself. */
  readonly path: string;
  /** Event from which on it is visible. Scoped variables are written right after the event that provides them. */
  readonly seen: number;
}

/** Greatest number of containers that a value passes through. */
const STEPS_MAX = 64;

/** Origin of the value that a port had after an event; null if its state had not run by then. */
export function originOf(
  machine: Machine,
  visits: Visits,
  port: DataPort,
  until: number | null,
  steps = STEPS_MAX,
): Origin | null {
  const kind = port.kind === "output" ? "left" : "entered";
  const sequence = visits.last(kind, port.path, until);
  if (sequence === null) return null;
  if (port.kind === "output") return { sequence, path: port.path, seen: sequence };
  if (port.kind === "scoped_variable") return scopedOrigin(machine, visits, port, sequence, until);
  const path = giverOf(machine, visits, port, sequence, steps);
  return { sequence, path: path ?? port.path, seen: sequence };
}

/** A scoped variable has the last value from a child, or else its value at the entry of its container. */
function scopedOrigin(
  machine: Machine,
  visits: Visits,
  port: DataPort,
  begun: number,
  until: number | null,
): Origin {
  let found = { sequence: begun, path: port.path };
  const before = until === null ? null : until - 1;
  for (const { from } of flowsTo(machine, port.path, port)) {
    if (from.kind !== "output") continue;
    const sequence = visits.last("left", from.path, before);
    if (sequence !== null && sequence > found.sequence) found = { sequence, path: from.path };
  }
  return { ...found, seen: visits.untilNext(found.sequence) };
}

/** State that provided the value of an input at its entry; null if none did. */
function giverOf(
  machine: Machine,
  visits: Visits,
  port: DataPort,
  entered: number,
  steps: number,
): string | null {
  const container = parentOf(port.path);
  if (container === null || steps === 0) return null;
  let found: Origin | null = null;
  for (const { from } of flowsTo(machine, container, port)) {
    if (!isPort(from)) continue;
    const given = originOf(machine, visits, from, entered, steps - 1);
    if (given && (!found || given.sequence > found.sequence)) found = given;
  }
  return found?.path ?? null;
}

function flowsTo(machine: Machine, container: string, port: DataPort): readonly ConnectionEnds[] {
  const state = machine.state(container);
  if (!state) return [];
  return dataFlowsOf(state).flatMap((flow) => {
    const ends = flowEnds(machine, container, flow);
    const isHere =
      ends?.to.kind === port.kind &&
      ends.to.path === port.path &&
      "id" in ends.to &&
      ends.to.id === port.id;
    return ends && isHere ? [ends] : [];
  });
}
