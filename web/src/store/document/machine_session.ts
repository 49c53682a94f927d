/** An open machine in the page: what is shown, what is on its way, who else is there. */

import type { ReadonlySignal } from "@preact/signals-core";
import type {
  Edit,
  MachineProblem,
  MachineStatus,
  MachineSteps,
  Presence,
} from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import type { StepChange } from "./step_change.ts";

/** An edit that was made here and not answered yet: it is shown already where it can be predicted. */
export interface PendingEdit {
  readonly id: string;
  readonly name: string;
  readonly since_ms: number;
}

/** What became of an edit. */
export type EditAnswer = { readonly revision: number } | { readonly refused: string };

export function wasRefused(answer: EditAnswer): answer is { readonly refused: string } {
  return "refused" in answer;
}

/** What became of a jump. `code` says why it was refused, for programs. */
export type JumpAnswer =
  | { readonly revision: number }
  | { readonly refused: string; readonly code: string };

export interface ProposedEdit {
  readonly name: string;
  readonly edit: Edit;
}

/** A layout that is shown although the machine does not have it: the next edit or save makes it first. */
export interface LayoutProposal {
  readonly shown: ReadonlySignal<ProposedEdit | null>;
  /** True while a machine without a drawing waits for its automatic layout. */
  readonly isDue: ReadonlySignal<boolean>;
  readonly show: (edit: ProposedEdit) => void;
  /** Makes it an edit, if there is one. */
  readonly keep: () => Promise<void>;
}

export interface MachineSession {
  /** The server's id of the open machine; another one if it had to be opened anew in another folder. */
  readonly id: string;
  /** Why nothing of it can be edited; null if it can be, as far as rights go. */
  readonly fixed: string | null;
  /** What is shown: the confirmed machine with pending edits upon it. The object stays; `version` tells of changes. */
  readonly machine: Machine;
  readonly version: ReadonlySignal<number>;
  /** Told after each change: the paths of states that are different, or null for all. Returns the way to stop. */
  readonly onChange: (listener: (touched: ReadonlySet<string> | null) => void) => () => void;
  /** The latest truth of the server; null before it came. */
  readonly status: ReadonlySignal<MachineStatus | null>;
  /** Others who look at the machine. */
  readonly people: ReadonlySignal<readonly Presence[]>;
  readonly pending: ReadonlySignal<readonly PendingEdit[]>;
  /** The steps that are known, the oldest first: a tree. */
  readonly steps: ReadonlySignal<MachineSteps>;
  /** What a step changed, if it was told since the page follows the machine and not too long ago. */
  readonly stepChange: (revision: number) => StepChange | undefined;
  /** The revision that the confirmed machine is at. */
  readonly revision: ReadonlySignal<number>;
  /** What is wrong with the machine, as of the last change that settled. */
  readonly problems: ReadonlySignal<readonly MachineProblem[]>;
  /** A text for people, with the names of states in the place of their paths. */
  readonly named: (text: string) => string;
  /** Whether the problems are those of the machine as it is now; never true of the machine of a run, which nobody checks. */
  readonly isChecked: ReadonlySignal<boolean>;
  /** Has the machine checked as it is now; null if that cannot be done. */
  readonly check: () => Promise<readonly MachineProblem[] | null>;
  /** An automatic layout of a machine without a drawing; missing where nothing can be edited. */
  readonly proposal?: LayoutProposal;
  /** Makes an edit. Never throws; what is refused is also told to the user. */
  readonly edit: (name: string, edit: Edit) => Promise<EditAnswer>;
  readonly undo: () => Promise<EditAnswer>;
  readonly redo: () => Promise<EditAnswer>;
  /** Makes the machine what it was at a revision; refused with `others_edits` if that takes steps of others away unasked. */
  readonly jump: (revision: number, overOthers: boolean) => Promise<JumpAnswer>;
  /** Gets the content of the library at this library state, to be shown in place. Why it cannot be had is told to the user. */
  readonly loadLibrary: (path: string) => Promise<void>;
  readonly close: () => void;
}
