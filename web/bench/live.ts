/** A run in the page under measurement: begun, shown, and how old the truth is that is painted. */

import type { Page as Sheet } from "playwright-core";
import type { Server } from "../e2e/support/server.ts";
import type { RunNow } from "../src/model/generated/protocol.ts";
import { FRAME, open, type Size } from "./support.ts";

/** Does the work while the page shows a run of the machine. Whatever comes, the run ends. */
export async function whileShown<T>(
  sheet: Sheet,
  server: Server,
  machine: Size,
  work: (run: string) => Promise<T>,
): Promise<T> {
  await open(sheet, machine);
  const run = await started(sheet, machine);
  try {
    await sheet.evaluate((id) => window.__rafcon.page.showRun(id).then(() => undefined), run);
    await sheet.waitForFunction(
      () => (window.__rafcon.page.active.value?.run.value?.journal.length ?? 0) > 10,
    );
    return await work(run);
  } finally {
    await server.ask("POST", `/runs/${run}/commands`, { id: "end", command: { type: "stop" } });
    await untilOver(server, run);
  }
}

function started(sheet: Sheet, machine: Size): Promise<string> {
  return sheet.evaluate((path) => {
    const { page } = window.__rafcon;
    const project = page.projects.value[0]?.id ?? "";
    return page.runs.start({ machine: { project, path }, inputs: { time_scale: 0 } });
  }, machine);
}

async function untilOver(server: Server, run: string): Promise<void> {
  for (;;) {
    const now = await server.ask<RunNow>("GET", `/runs/${run}`);
    if (now.run.phase !== "live") return;
    await new Promise((over) => setTimeout(over, 100));
  }
}

interface Ages {
  isOver: boolean;
  readonly ages: number[];
}

/** Notes from now on at each frame of the browser how old the truth is that the canvas shows. Gives the way to stop, which gives
 * the ages in ms by the runner's own clock, which is that of this computer. */
export async function notedAges(sheet: Sheet): Promise<() => Promise<readonly number[]>> {
  const noted = await sheet.evaluateHandle((frame): Ages => {
    const noted: Ages = { isOver: false, ages: [] };
    let painted: number | null = null;
    let before: number | null = null;
    let last = 0;
    const look = (time: number) => {
      if (noted.isOver) return;
      const now = window.__rafcon.page.active.value?.run.value?.now.value?.snapshot_ms ?? null;
      const drawn = performance.getEntriesByName(frame).at(-1)?.startTime ?? last;
      if (drawn > last) painted = drawn >= time ? now : before;
      [last, before] = [drawn, now];
      if (painted !== null) noted.ages.push(Date.now() - painted);
      requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
    return noted;
  }, FRAME);
  return () =>
    noted.evaluate((them) => {
      them.isOver = true;
      return them.ages;
    });
}
