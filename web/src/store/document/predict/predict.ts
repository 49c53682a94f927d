/** What an edit will do, before the server has said so. Only what is sure is predicted: rules are the server's. */

import type { Edit } from "../../../model/generated/protocol.ts";
import type { Machine } from "../../../model/machine.ts";
import { children } from "./children.ts";
import { connections } from "./connections.ts";
import { ownInterface } from "./interface.ts";
import { moved } from "./moved.ts";
import { own } from "./own.ts";
import { places } from "./places.ts";
import { PredictedMachine, type Write } from "./predicted_machine.ts";

/** The writes that the edit comes to; null if only the server knows. */
export function predictedWrites(machine: Machine, edit: Edit): readonly Write[] | null {
  const predicted = new PredictedMachine(machine);
  return write(predicted, edit) ? predicted.writes : null;
}

/** What comes by the thousand is looked for first. */
const KINDS = [places, own, ownInterface, connections, children, moved];

function write(predicted: PredictedMachine, edit: Edit): boolean {
  if (edit.edit === "batch") return edit.edits.every((each) => write(predicted, each));
  return KINDS.some((kind) => kind(predicted, edit));
}
