/** The page under measurement: a browser without a GPU, the real server with the two machines, and how they are opened. */

import { spawnSync } from "node:child_process";
import { existsSync, rmSync } from "node:fs";
import { join } from "node:path";
import {
  type Browser,
  type BrowserContextOptions,
  chromium,
  type Page as Sheet,
} from "playwright-core";
import { binary, CHROMIUM, newPlace, REPOSITORY } from "../e2e/house/places.ts";
import { Server } from "../e2e/house/server.ts";
import { writeLarge } from "./large.ts";

export const VIEW = { width: 1600, height: 1000 };

/** What the canvas calls its frames on the browser's time line. */
export const FRAME = "rafcon:frame";

/** The machines by name: the mission that `rafcon new` makes, and ours. */
export type Size = "mission_750" | "large_10000";

export interface House {
  readonly server: Server;
  readonly browser: Browser;
}

export async function begin(): Promise<House> {
  const server = await Server.start(newPlace(machines()));
  const browser = await chromium.launch({
    executablePath: CHROMIUM,
    args: ["--no-sandbox", "--disable-gpu", "--force-device-scale-factor=1"],
  });
  return { server, browser };
}

export async function end({ server, browser }: House): Promise<void> {
  await browser.close();
  await server.dispose();
}

/** Both are made afresh: they say what is measured. */
function machines(): Record<Size, string> {
  const folder = join(REPOSITORY, "target", "bench-web");
  const [mission, large] = [join(folder, "mission_750"), join(folder, "large_10000")];
  rmSync(folder, { recursive: true, force: true });
  const made = spawnSync(binary(), ["new", "--template", "mission", "--states", "750", mission]);
  if (made.status !== 0) throw new Error(`no mission was made: ${made.stderr}`);
  if (!existsSync(large)) writeLarge(large);
  return { mission_750: mission, large_10000: large };
}

/** A fresh page in a profile of its own, let in and waiting for a machine. */
export async function freshPage(
  { server, browser }: House,
  options: BrowserContextOptions = {},
): Promise<Sheet> {
  const context = await browser.newContext({ viewport: VIEW, ...options });
  const sheet = await context.newPage();
  sheet.on("pageerror", (error) => process.stderr.write(`the page: ${error.message}\n`));
  await sheet.goto(server.link);
  await sheet.getByRole("treeitem", { name: "mission_750" }).waitFor();
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
        commands.run("file.open", context(), { project, path: name });
      }),
    [size, FRAME] as const,
  );
}

/** Closes the machine here and on the server, so that it is read from disk when it is opened again. */
export async function forget(sheet: Sheet, server: Server): Promise<void> {
  const id = await sheet.evaluate(() => window.__rafcon.page.active.value?.room.id);
  await sheet.context().close();
  await server.ask("POST", `/machines/${id}/close`, { discard: true });
}
