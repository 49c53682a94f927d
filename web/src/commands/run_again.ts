/** Commands that start a run without the open machine: again, as an earlier run, or on a robot of this station. */

import { effect } from "@preact/signals-core";
import type { MachineFile } from "../model/generated/protocol.ts";
import { isLive } from "../model/run_words.ts";
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
      if (isLive(phase)) return "the run is still active";
      if (page.server.link.value.state !== "up") return "there is no connection to the server";
      const watch = tab?.run.value;
      return lacks(page, "start") ?? (watch ? robotRefuses(watch, "start") : null);
    },
    run: startAgain,
  },
  {
    id: "run.start-at-robot",
    title: "Start a machine of a robot…",
    detail: "Chooses a machine of a robot's projects. The robot starts it.",
    menu: "Run/1",
    refusal: ({ page }) => {
      if (page.server.link.value.state !== "up") return "there is no connection to the server";
      if (page.robots.value.length === 0) return "this server is not the station of a robot";
      return lacks(page, "start");
    },
    run: startAtRobot,
  },
];

async function startAtRobot({ page, shell }: CommandContext): Promise<void> {
  const chosen = await shell.dialog("start-at-robot", undefined);
  if (chosen === null) return;
  const { robot, machine } = chosen;
  page.tell({ level: "info", text: `${robot} is asked to start ${pathOf(machine)}.` });
  const before = page.active.peek();
  const run = await page.runs.startAtRobot(robot, { machine });
  const text = `${robot} has started ${pathOf(machine)}. The run is shown here once its first events arrive.`;
  page.tell({ level: "info", text });
  const isLeft = () => page.active.value !== before;
  if (await arrived(page, run, isLeft)) await page.showRun(run);
}

/** Path of a machine for the user. */
export function pathOf({ project, path }: MachineFile): string {
  return path === "" ? project : `${project}/${path}`;
}

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
    const isLeft = () => page.active.value?.run.value !== watch;
    if (!(await arrived(page, run, isLeft))) return;
  }
  // A user who opened another run in the meantime stays there.
  if (page.active.peek()?.run.peek() === watch) await page.showRun(run);
}

/** Waits for a run to appear in the list of runs; false if the user has gone elsewhere first. */
function arrived(page: Page, run: string, isLeft: () => boolean): Promise<boolean> {
  return new Promise((done) => {
    const end = (isHere: boolean) => {
      done(isHere);
      queueMicrotask(() => stop());
    };
    const stop = effect(() => {
      if (isLeft()) end(false);
      else if (page.runs.all.value.some(({ id }) => id === run)) end(true);
    });
  });
}
