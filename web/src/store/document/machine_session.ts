/** An open machine in the page: its content, pending edits and other users. */

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

/** An edit that was made here and has no answer yet. Its effect is shown if it can be predicted. */
export interface PendingEdit {
  readonly id: string;
  readonly name: string;
  readonly since_ms: number;
}

/** Result of an edit. */
export type EditAnswer = { readonly revision: number } | { readonly refused: string };

export function wasRefused(answer: EditAnswer): answer is { readonly refused: string } {
  return "refused" in answer;
}

/** Result of a jump. `code` is the machine-readable reason of a refusal. */
export type JumpAnswer =
  | { readonly revision: number }
  | { readonly refused: string; readonly code: string };

export interface ProposedEdit {
  readonly name: string;
  readonly edit: Edit;
}

/** A layout that is shown before the machine has it. The next edit or save applies it first. */
export interface LayoutProposal {
  readonly shown: ReadonlySignal<ProposedEdit | null>;
  /** True while a machine without a drawing waits for its automatic layout. */
  readonly isDue: ReadonlySignal<boolean>;
  readonly show: (edit: ProposedEdit) => void;
  /** Applies the proposal as an edit, if there is one. */
  readonly keep: () => Promise<void>;
}

export interface MachineSession {
  /** The server's id of the open machine. It changes if the machine has to be reopened in another folder. */
  readonly id: string;
  /** Reason why the machine cannot be edited, apart from rights; null if it can. */
  readonly fixed: string | null;
  /** Machine on display: the confirmed machine with pending edits applied. The object stays; `version` changes with its content. */
  readonly machine: Machine;
  readonly version: ReadonlySignal<number>;
  /** Calls the listener after each change with the paths of changed states, or null for all. Returns a function that removes it. */
  readonly onChange: (listener: (touched: ReadonlySet<string> | null) => void) => () => void;
  /** Latest status from the server; null before the first. */
  readonly status: ReadonlySignal<MachineStatus | null>;
  /** Other users who have the machine open. */
  readonly people: ReadonlySignal<readonly Presence[]>;
  readonly pending: ReadonlySignal<readonly PendingEdit[]>;
  /** Known steps, the oldest first, as a tree. */
  readonly steps: ReadonlySignal<MachineSteps>;
  /** Change of a step; undefined if it was made before the page followed the machine, or too long ago. */
  readonly stepChange: (revision: number) => StepChange | undefined;
  /** Revision of the confirmed machine. */
  readonly revision: ReadonlySignal<number>;
  /** Problems of the machine, as of its last settled change. */
  readonly problems: ReadonlySignal<readonly MachineProblem[]>;
  /** Replaces state paths by names in a text for people. */
  readonly named: (text: string) => string;
  /** True if the problems are up to date. Always false for the machine of a run, which is not checked. */
  readonly isChecked: ReadonlySignal<boolean>;
  /** Checks the machine in its current form; null if that fails. */
  readonly check: () => Promise<readonly MachineProblem[] | null>;
  /** Automatic layout of a machine without a drawing; missing if it cannot be edited. */
  readonly proposal?: LayoutProposal;
  /** Makes an edit. Never throws; refusals are also reported to the user. */
  readonly edit: (name: string, edit: Edit) => Promise<EditAnswer>;
  readonly undo: () => Promise<EditAnswer>;
  readonly redo: () => Promise<EditAnswer>;
  /** Restores the machine of a revision. Without `overOthers`, it is refused with `others_edits` if that undoes steps of other users. */
  readonly jump: (revision: number, overOthers: boolean) => Promise<JumpAnswer>;
  /** Loads the content of the library at this library state, to show it in place. Failures are reported to the user. */
  readonly loadLibrary: (path: string) => Promise<void>;
  readonly close: () => void;
}
