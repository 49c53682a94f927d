/** Commands for crashed runs, and for runs of an edited machine. */

import type { OnCrash } from "../model/generated/protocol.ts";
import { activeStates } from "../store/run/active.ts";
import { fileOfTab, liveRun } from "../store/run/running.ts";
import type { CommandContext, UserCommand } from "./command.ts";
import { cannotCommand, lacks, robotRefuses } from "./run_rules.ts";
import { isChanged, saveTab } from "./save.ts";
import { failureOf, sendCommand, sendCommandTo } from "./send_command.ts";
import { anyOnlyState, canEdit } from "./subject.ts";

export const RUN_CRASH: readonly UserCommand[] = [
  {
    id: "run.resume-crashed",
    title: "Resume the crashed run…",
    detail: "Starts a new program that continues where the run was when its program died.",
    menu: "Run/2",
    refusal: ({ page, tab }) => {
      const watch = tab?.run.value;
      const phase = watch?.now.value?.run.phase;
      if (!watch || phase !== "crashed") return "only for runs whose program died";
      return lacks(page, "start") ?? robotRefuses(watch, "command");
    },
    run: resumeCrashed,
  },
  {
    id: "run.recover",
    title: "Interrupted scripts",
    detail:
      "Decides what happens to scripts that a crash interrupted: in the selected state, or in all.",
    menu: "Run/6",
    refusal: (context) => {
      const isWaiting = interrupted(context).length > 0;
      return (
        cannotCommand(context) ?? (isWaiting ? null : "no interrupted script waits for a decision")
      );
    },
    choices: (context) => {
      const selected = anyOnlyState(context)?.path ?? null;
      const path = interrupted(context).includes(selected ?? "") ? selected : null;
      const what = path === null ? "all" : "the selected";
      return [
        { title: `Run ${what} again`, argument: { path, policy: "restart" } },
        { title: `End ${what} as aborted`, argument: { path, policy: "abort" } },
      ];
    },
    run: (context, argument) => {
      if (!argument) return;
      const { path, policy } = argument;
      return sendCommand(context, "Interrupted scripts", { type: "recover", path, policy });
    },
  },
  {
    id: "run.reload",
    title: "Apply edits to the run",
    detail: "Saves the machine. The run uses it from now on.",
    menu: "Run/6",
    refusal: (context) => {
      const why = cannotCommand(context, { right: "edit" });
      return why ?? (canEdit(context) ? null : "this tab shows the machine as it ran");
    },
    run: reload,
  },
];

/** Paths of the states whose scripts were interrupted. */
function interrupted({ tab }: CommandContext): readonly string[] {
  const watch = liveRun(tab);
  const all = watch ? activeStates(watch) : [];
  return all.filter(({ phase }) => phase === "interrupted").map(({ path }) => path);
}

async function resumeCrashed(context: CommandContext, given?: OnCrash): Promise<void> {
  const { page, tab, shell } = context;
  const watch = tab?.run.peek();
  if (!watch) return;
  const policy = given ?? (await shell.dialog("resume-crashed", watch));
  if (!policy) return;
  const robot = watch.now.peek()?.run.robot;
  if (robot) page.tell({ level: "info", text: `${robot} is asked to resume the run.` });
  await watch.resume(policy);
  if (robot) {
    const text = `${robot} has resumed the run. Its first events are on their way.`;
    page.tell({ level: "info", text });
  }
}

async function reload(context: CommandContext): Promise<void> {
  const { page, tab, shell } = context;
  const watch = liveRun(tab);
  if (!tab || !watch || fileOfTab(tab) === null) return;
  if (isChanged(tab) && !(await saveTab(context, tab))) return;
  const sent = await watch.command({ type: "reload", wait: false });
  const why = failureOf(sent);
  if (why === null)
    return page.tell({ level: "info", text: "The run now uses the edited machine." });
  if (sent.answer?.answer !== "refused") {
    return page.tell({ level: "warning", text: `Apply edits to the run: ${why}` });
  }
  const waits = await shell.confirm({
    title: "The edits cannot be applied now",
    text: `${why.replace(/\.$/, "")}. They can be applied once that state has ended.`,
    yes: "Apply them then",
    no: "Don't apply",
  });
  if (!waits) return;
  await sendCommandTo(context, watch, "Apply edits to the run", { type: "reload", wait: true });
}
