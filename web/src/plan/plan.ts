/** Result of a gesture or command: one named edit, or the reason of a refusal. */

import type { ElementRef } from "../model/element.ts";
import type { Edit } from "../model/generated/protocol.ts";

/** One step of the history, not sent yet. */
export interface Plan {
  /** Name of the step in the history, such as "Move state". */
  readonly name: string;
  readonly edit: Edit;
  /** Selection after the edit; unchanged by default. */
  readonly select?: readonly ElementRef[];
}

/** A refusal in one sentence: cause, place and remedy. */
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
