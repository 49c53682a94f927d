/** The page under measurement: a browser without a GPU, the real server with the two machines, and how they are opened. */

import { spawnSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Browser, BrowserContextOptions, Page as Sheet } from "playwright-core";
import { launch } from "../e2e/support/chromium.ts";
import { binary, newPlace } from "../e2e/support/places.ts";
import { Server } from "../e2e/support/server.ts";
import { makeEndless } from "./endless.ts";
import { writeLarge } from "./large.ts";
import { makePosing } from "./posing.ts";

export const VIEW = { width: 1600, height: 1000 };

/** What the canvas calls its frames on the browser's time line. */
export const FRAME = "rafcon:frame";

/** The machines by name: the mission that `rafcon new` makes, the same for pictures and without an end, and ours. */
export type Size = "mission_750" | "rover_750" | "endless_750" | "large_10000";

/** So many states change in a second in the mission that does not end, if nothing else is said. */
const LIVE_RATE = 1_000;

export interface BenchSetup {
  readonly server: Server;
  readonly browser: Browser;
}

/** With these machines; so many states change in a second in the one that does not end. */
export async function begin(sizes: readonly Size[], rate = LIVE_RATE): Promise<BenchSetup> {
  const server = await Server.start(newPlace(made(sizes, rate)));
  return { server, browser: await launch() };
}

export async function end({ server, browser }: BenchSetup): Promise<void> {
  await browser.close();
  await server.dispose();
}

/** How each machine is made. Afresh: that says what is measured. */
const MAKING: Readonly<Record<Size, (folder: string, rate: number) => void>> = {
  mission_750: newMission,
  rover_750: (folder) => {
    newMission(folder);
    makePosing(folder);
  },
  endless_750: (folder, rate) => {
    newMission(folder);
    makeEndless(folder, rate);
  },
  large_10000: writeLarge,
};

function made(sizes: readonly Size[], rate: number): Record<string, string> {
  const folder = mkdtempSync(join(tmpdir(), "rafcon-bench-"));
  process.once("exit", () => rmSync(folder, { recursive: true, force: true }));
  const machines = sizes.map((size) => [size, join(folder, size)] as const);
  for (const [size, place] of machines) MAKING[size](place, rate);
  return Object.fromEntries(machines);
}

function newMission(folder: string): void {
  const made = spawnSync(binary(), ["new", "--template", "mission", "--states", "750", folder]);
  if (made.status !== 0) throw new Error(`no mission was made: ${made.stderr}`);
}

/** A fresh page in a profile of its own, let in and waiting for a machine. */
export async function freshPage(
  { server, browser }: BenchSetup,
  options: BrowserContextOptions = {},
): Promise<Sheet> {
  const context = await browser.newContext({ viewport: VIEW, ...options });
  await context.addInitScript("window.__rafcon = null");
  const sheet = await context.newPage();
  sheet.on("pageerror", (error) => process.stderr.write(`the page: ${error.message}\n`));
  await sheet.goto(server.link);
  await sheet
    .getByRole("treeitem", { name: /_(750|10000)$/ })
    .first()
    .waitFor();
  return sheet;
}

/** Opens a machine as the command does; the ms from there to its first picture. */
export async function open(sheet: Sheet, size: Size): Promise<number> {
  return sheet.evaluate(
    ([name, frame]) =>
      new Promise<number>((done) => {
        const { page, commands, context } = window.__rafcon;
        const begun = performance.now();
        const seen = new PerformanceObserver((list) => {
          const picture = list.getEntriesByName(frame).find(({ startTime }) => startTime >= begun);
          if (!picture || !page.active.value) return;
          seen.disconnect();
          done(picture.startTime + picture.duration - begun);
        });
        seen.observe({ type: "measure" });
        const project = page.projects.value[0]?.id;
        if (project) commands.run("file.open", context(), { project, path: name });
      }),
    [size, FRAME] as const,
  );
}

/** Closes the machine here and on the server, so that it is read from disk when it is opened again. */
export async function forget(sheet: Sheet, server: Server): Promise<void> {
  const id = await sheet.evaluate(() => window.__rafcon.page.active.value?.session.id);
  await sheet.context().close();
  await server.ask("POST", `/machines/${id}/close`, { discard: true });
}
