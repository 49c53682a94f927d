/** First commands of the Run menu: start, pause, resume and stop. */

import type { Watch } from "../store/history/run.ts";
import type { CommandContext, UserCommand } from "./command.ts";
import { cannotCommand, cannotStart, cannotWhile } from "./run_rules.ts";
import { startRun } from "./run_start.ts";
import { sendCommand, sendCommandTo } from "./send_command.ts";

export const RUN: readonly UserCommand[] = [
  {
    id: "run.start",
    title: "Start",
    detail: "Starts a run of the saved machine.",
    keys: ["Shift+F7"],
    classic: ["F5", "Shift+F7"],
    menu: "Run/1",
    refusal: cannotStart,
    run: (context, argument) => startRun(context, argument ?? {}),
  },
  {
    id: "run.start-with",
    title: "Start with…",
    detail: "Sets input values, a pause before the first state, and what happens after a crash.",
    menu: "Run/1",
    refusal: cannotStart,
    run: async (context) => {
      const { tab, shell } = context;
      const wanted = tab && (await shell.dialog("start-run", tab));
      if (wanted) await startRun(context, wanted);
    },
  },
  {
    id: "run.start-held",
    title: "Start paused",
    detail: "Pauses before the first state, to step or resume from there.",
    menu: "Run/1",
    refusal: cannotStart,
    run: (context) => startRun(context, { hold: true }),
  },
  {
    id: "run.toggle-pause",
    title: "Pause or resume",
    keys: ["F7"],
    menu: "Run/2",
    refusal: (context) => (canResume(context) ? cannotResume(context) : cannotPause(context)),
    run: (context) =>
      canResume(context)
        ? sendCommand(context, "Resume", RESUME)
        : sendCommand(context, "Pause", PAUSE),
  },
  {
    id: "run.pause",
    title: "Pause",
    detail: "Pauses every branch before its next state. Running scripts finish.",
    refusal: cannotPause,
    run: (context) => sendCommand(context, "Pause", PAUSE),
  },
  {
    id: "run.resume",
    title: "Resume",
    detail: "Continues everything that is paused and ends stepping.",
    refusal: cannotResume,
    run: (context, branch) =>
      sendCommand(context, "Resume", {
        type: "resume",
        branch: typeof branch === "string" ? branch : null,
      }),
  },
  {
    id: "run.stop",
    title: "Stop",
    detail: "Preempts the whole run. Handlers still run.",
    keys: ["F8"],
    menu: "Run/2",
    refusal: (context) => cannotCommand(context, { rest: true }),
    run: async (context, argument) => {
      const watch = context.tab?.run.peek();
      if (!watch || (argument !== "sure" && !(await confirmStop(context, watch)))) return;
      await sendCommandTo(context, watch, "Stop", { type: "stop" });
    },
  },
  {
    id: "run.kill",
    title: "Kill the runner…",
    detail: "Ends the run's program at once. No handler runs. Use it when Stop has no effect.",
    menu: "Run/2",
    refusal: (context) => cannotCommand(context),
    run: async (context) => {
      const watch = context.tab?.run.peek();
      if (!watch) return;
      const isSure = await context.shell.confirm({
        title: "Kill the runner?",
        text: "Its program ends at once. No handler runs, and devices stay as they are. The run can be resumed later.",
        yes: "Kill",
        danger: true,
      });
      if (isSure) await sendCommandTo(context, watch, "Kill", { type: "kill" });
    },
  },
];

const PAUSE = { type: "pause" } as const;
const RESUME = { type: "resume", branch: null } as const;

function canResume({ tab }: CommandContext): boolean {
  const status = tab?.run.value?.now.value?.snapshot?.status;
  return status === "paused" || status === "stepping";
}

function cannotPause(context: CommandContext): string | null {
  return cannotWhile(context, ["running", "stepping"], { rest: true });
}

function cannotResume(context: CommandContext): string | null {
  const why = cannotCommand(context);
  if (why !== null || canResume(context)) return why;
  const status = context.tab?.run.value?.now.value?.snapshot?.status;
  return status === "stopping" ? "the run is being stopped" : "the run is already running";
}

function confirmStop({ shell }: CommandContext, watch: Watch): Promise<boolean> {
  const isAgain = watch.now.peek()?.snapshot?.status === "stopping";
  return shell.confirm({
    title: isAgain ? "Stop again?" : "Stop the run?",
    text: isAgain
      ? "The run is already stopping. A second stop also preempts handlers and starts no new ones."
      : "All active states are preempted, then handlers run. A stopped run cannot be resumed.",
    yes: isAgain ? "Stop handlers too" : "Stop the run",
    no: isAgain ? "Let handlers finish" : "Keep running",
    danger: true,
  });
}
