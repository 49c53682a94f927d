/** The command that repeats a run: a new run with its inputs and settings, started by the robot if the run is a robot's. */

import { effect } from "@preact/signals-core";
import type { Watch } from "../store/history/run.ts";
import type { Page } from "../store/page/page.ts";
import type { CommandContext, UserCommand } from "./command.ts";
import { lacks, robotRefuses } from "./run_rules.ts";

export const RUN_AGAIN: readonly UserCommand[] = [
  {
    id: "run.start-again",
    title: "Start again…",
    detail: "Starts a new run with the inputs and settings of this run.",
    menu: "Run/1",
    refusal: ({ page, tab }) => {
      const phase = tab?.run.value?.now.value?.run.phase;
      if (phase === undefined) return "no run is shown here: start one, or choose one";
      if (phase === "live" || phase === "starting") return "the run is still active";
      if (page.server.link.value.state !== "up") return "there is no connection to the server";
      const watch = tab?.run.value;
      return lacks(page, "start") ?? (watch ? robotRefuses(watch, "start") : null);
    },
    run: startAgain,
  },
];

async function startAgain({ page, tab, shell }: CommandContext): Promise<void> {
  const watch = tab?.run.peek();
  const before = watch?.now.peek()?.run;
  if (!watch || !before) return;
  const robot = before.robot ?? null;
  const isSure = await shell.confirm({
    title: robot === null ? "Start the run again?" : `Start the run again on ${robot}?`,
    text: `A new run of “${before.name}” starts with the inputs and settings of this run.`,
    yes: "Start again",
    danger: robot !== null,
  });
  if (!isSure) return;
  if (robot) page.tell({ level: "info", text: `${robot} is asked to start the run.` });
  const { run } = await watch.startAgain();
  if (robot) {
    const text = `${robot} has started the run. It is shown here once its first events arrive.`;
    page.tell({ level: "info", text });
    if (!(await arrived(page, watch, run))) return;
  }
  // A user who opened another run in the meantime stays there.
  if (page.active.peek()?.run.peek() === watch) await page.showRun(run);
}

/** Waits for a run to appear in the list of runs; false if the page left the run before it first. */
function arrived(page: Page, before: Watch, run: string): Promise<boolean> {
  return new Promise((done) => {
    const end = (isHere: boolean) => {
      done(isHere);
      queueMicrotask(() => stop());
    };
    const stop = effect(() => {
      if (page.runs.all.value.some(({ id }) => id === run)) end(true);
    });
    before.whenClosed(() => end(false));
  });
}
