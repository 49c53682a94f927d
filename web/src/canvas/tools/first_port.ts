/** Start of a connection that is drawn by keyboard. */

import type { ElementRef } from "../../model/element.ts";
import { isConnection } from "../../model/ends.ts";
import { type Machine, outcomesOf, portsOf, transitionsOf } from "../../model/machine.ts";
import { idOf, parentOf } from "../../model/path.ts";
import type { CanvasPort } from "../hit/look.ts";

/** Port itself. For a state: its first unconnected outcome, or its first outcome, or its first output. */
export function firstPort(machine: Machine, from: ElementRef): CanvasPort | null {
  if (isConnection(from)) return null;
  if (from.kind !== "state") return from as CanvasPort;
  const { path } = from;
  const state = machine.state(path);
  if (!state) return null;
  if (parentOf(path) === null) return { kind: "income", path };
  const taken = takenOutcomes(machine, path);
  const own = outcomesOf(state).filter(({ id }) => id >= 0);
  const outcome = own.find(({ id }) => !taken.has(id)) ?? own[0];
  if (outcome) return { kind: "outcome", path, id: outcome.id };
  const [output] = portsOf(state, "output");
  return output ? { kind: "output", path, id: output.id } : { kind: "outcome", path, id: -1 };
}

function takenOutcomes(machine: Machine, path: string): ReadonlySet<number> {
  const parent = parentOf(path);
  const container = parent === null ? undefined : machine.state(parent);
  const leaving = container
    ? transitionsOf(container).filter((one) => one.from_state === idOf(path))
    : [];
  return new Set(leaving.map((one) => one.from_outcome ?? 0));
}
