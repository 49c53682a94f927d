/** What a gesture or command comes to: one named edit, or the reason why not. */

import type { ElementRef } from "../model/element.ts";
import type { Edit } from "../model/generated/protocol.ts";

/** One step of the history, not sent yet. */
export interface Plan {
  /** What the step is called in the history: "Move state". */
  readonly name: string;
  readonly edit: Edit;
  /** What is to be selected once it is done; left out: the selection stays. */
  readonly select?: readonly ElementRef[];
}

/** Why something cannot be done: what, where, and the way out, in one sentence. */
export interface Refused {
  readonly refused: string;
}

export type Planned = Plan | Refused;

export function isRefused(planned: unknown): planned is Refused {
  return typeof planned === "object" && planned !== null && "refused" in planned;
}

export function refused(reason: string): Refused {
  return { refused: reason };
}

/** Several edits as one; one stays itself. */
export function together(edits: readonly Edit[]): Edit {
  const [only] = edits;
  return edits.length === 1 && only ? only : { edit: "batch", edits: [...edits] };
}
