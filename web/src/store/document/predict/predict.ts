/** Predicts the effect of an edit before the server confirms it. Only certain effects are predicted; the server enforces the rules. */

import type { Edit } from "../../../model/generated/protocol.ts";
import type { Machine } from "../../../model/machine.ts";
import { children } from "./children.ts";
import { connections } from "./connections.ts";
import { ownInterface } from "./interface.ts";
import { moved } from "./moved.ts";
import { own } from "./own.ts";
import { places } from "./places.ts";
import { PredictedMachine, type Write } from "./predicted_machine.ts";

/** Writes of the edit; null if only the server knows its effect. */
export function predictedWrites(machine: Machine, edit: Edit): readonly Write[] | null {
  const predicted = new PredictedMachine(machine);
  return write(predicted, edit) ? predicted.writes : null;
}

/** The most frequent edits first. */
const KINDS = [places, own, ownInterface, connections, children, moved];

function write(predicted: PredictedMachine, edit: Edit): boolean {
  if (edit.edit === "batch") return edit.edits.every((each) => write(predicted, each));
  return KINDS.some((kind) => kind(predicted, edit));
}
