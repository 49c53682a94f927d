/** Steps: into, over, out and back, of all branches that are held or of one. */

import { snapshotOf } from "../store/run/running.ts";
import type { CommandContext, UserCommand } from "./command.ts";
import { cannotCommand, cannotWhile, isHeld } from "./run_rules.ts";
import { sendCommand } from "./send_command.ts";

type StepType = "step_into" | "step_over" | "step_out" | "step_back";

export const RUN_STEP: readonly UserCommand[] = [
  {
    id: "run.step-mode",
    title: "Step mode",
    detail: "Pauses before the next state, to step from there.",
    keys: ["F6"],
    menu: "Run/3",
    checked: ({ tab }) => snapshotOf(tab?.run.value ?? null)?.status === "stepping",
    refusal: (context) => cannotWhile(context, ["running", "paused"]),
    run: (context) => sendCommand(context, "Step mode", { type: "step_mode" }),
  },
  step("run.into", "Step into", "step_into", ["F4"], "Runs to the next state at any level."),
  step(
    "run.over",
    "Step over",
    "step_over",
    ["Shift+F4"],
    "Runs to the next state of this container or an outer one.",
  ),
  step("run.out", "Step out", "step_out", ["F3"], "Runs to the next state of an outer container."),
  step(
    "run.back",
    "Step back",
    "step_back",
    ["F9"],
    "Undoes the last state: runs its script backward and restores its data.",
  ),
];

function step(
  id: "run.into" | "run.over" | "run.out" | "run.back",
  title: string,
  type: StepType,
  keys: readonly string[],
  detail: string,
): UserCommand {
  return {
    id,
    title,
    detail,
    keys,
    menu: "Run/3",
    refusal: (context) => cannotStep(context, type),
    run: (context, argument) => sendCommand(context, title, { type, branch: argument ?? null }),
  };
}

function cannotStep(context: CommandContext, type: StepType): string | null {
  const why = cannotCommand(context);
  const snapshot = snapshotOf(context.tab?.run.value ?? null);
  if (why !== null || !snapshot) return why ?? "the run is starting";
  if (snapshot.status !== "paused" && snapshot.status !== "stepping") {
    return "nothing is paused: pause the run or turn on step mode";
  }
  const waits = type === "step_back" && snapshot.active.some(({ phase }) => phase === "waiting");
  return isHeld(snapshot) || waits ? null : "a script is running: step once the run has paused";
}
