/** Names of run commands, as used by buttons and menus. */

import type { Command } from "./generated/protocol.ts";

const WORDS: Readonly<Record<Command["type"], string>> = {
  start: "Start",
  pause: "Pause",
  resume: "Resume",
  stop: "Stop",
  kill: "Kill",
  step_mode: "Step mode",
  step_into: "Step into",
  step_over: "Step over",
  step_out: "Step out",
  step_back: "Step back",
  run_to: "Run to here",
  run_selected: "Run this state",
  run_only_selected: "Run this state only",
  start_from_history: "Start from a moment",
  force_outcome: "Force an outcome",
  preempt: "Preempt",
  set_breakpoint: "Set a breakpoint",
  remove_breakpoint: "Remove a breakpoint",
  answer_question: "Answer a question",
  recover: "Recover",
  reload: "Apply edits to the run",
  edit_script: "Change a script",
  control: "Control",
};

export function commandInWords(command: Command): string {
  return WORDS[command.type];
}

/** Name of a command type, or of a request about a whole run. */
export function commandTypeInWords(type: string): string {
  const words: Readonly<Record<string, string>> = WORDS;
  const requests = { resume_run: "Resume the run", start_run: "Start a run" };
  return { ...words, ...requests }[type] ?? type;
}
