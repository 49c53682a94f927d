/** The time of runs: started and finished for journeys, scrubbed in the page, and told by the command line for comparison. */

import { spawnSync } from "node:child_process";
import { join } from "node:path";
import { expect, vi } from "vitest";
import type { HistoryEntry, Moment, RunSummary } from "../../src/model/generated/protocol.ts";
import type { App } from "./app.ts";
import { PATIENCE } from "./patience.ts";
import { binary } from "./places.ts";
import type { Server } from "./server.ts";

let runs = 0;

/** Starts a machine of the project and gives its id. */
export async function started(
  server: Server,
  path: string,
  more: Readonly<Record<string, unknown>> = {},
): Promise<string> {
  runs += 1;
  const { id } = await server.ask<RunSummary>("POST", "/runs", {
    id: `time-${runs}`,
    machine: { project: "missions", path },
    inputs: {},
    start_from: null,
    keeping: "full",
    strict: false,
    hold: false,
    breakpoints: [],
    on_crash: null,
    size_max: null,
    ...more,
  });
  return id;
}

/** Starts a machine, and waits until its run is over. */
export async function finished(
  server: Server,
  path: string,
  more: Readonly<Record<string, unknown>> = {},
): Promise<string> {
  const id = await started(server, path, more);
  await vi.waitUntil(async () => {
    const now = await server.ask<{ run: RunSummary; link: string }>("GET", `/runs/${id}`);
    return now.run.phase === "finished" && now.link === "over";
  }, PATIENCE);
  return id;
}

/** Shows the run in the page, with all that happened in it. */
export async function shown(app: App, run: string): Promise<void> {
  await app.command("Layout: Debug");
  await app.sheet.evaluate(async (id) => {
    await window.__rafcon.page.showRun(id);
  }, run);
  await app.until(({ tab }, id) => {
    const watch = tab?.run.value;
    return watch?.id === id && watch.isCaughtUp.value && watch.journal.length > 0;
  }, run);
}

/** The moment that the page shows, once its values are here; null: live. */
export async function momentShown(app: App): Promise<number | null> {
  await app.until(({ tab }) => {
    const watch = tab?.run.value;
    const moment = watch?.playhead.value;
    return moment == null || watch?.playheadSnapshot.value?.picture.sequence === moment;
  }, null);
  return app.sheet.evaluate(
    () => window.__rafcon.page.active.value?.run.value?.playhead.value ?? null,
  );
}

/** Waits until the page shows this moment, with its values; null: live. */
export async function showsMoment(app: App, moment: number | null | undefined): Promise<void> {
  await expect.poll(() => momentShown(app)).toBe(moment);
}

/** Paths of the active states of the moment that the page shows. */
export async function activeShown(app: App): Promise<readonly string[]> {
  return app.sheet.evaluate(
    () =>
      window.__rafcon.page.active.value?.run.value?.playheadSnapshot.value?.picture.active.map(
        ({ path }) => path,
      ) ?? [],
  );
}

/** How the run stood after an event, as `rafcon replay` tells it. */
export function replayed(server: Server, run: string, at: number): Moment {
  const [line = ""] = rafcon(server, "replay", run, "--at", String(at), "--json");
  return JSON.parse(line) as Moment;
}

/** All that happened, as `rafcon history` tells it. */
export function historyOf(server: Server, run: string): readonly HistoryEntry[] {
  return rafcon(server, "history", run, "--json").map((line) => JSON.parse(line) as HistoryEntry);
}

function rafcon(server: Server, ...words: readonly string[]): readonly string[] {
  const env = { ...process.env, RAFCON_RUNS: join(server.place.folder, "runs") };
  const { status, stdout, stderr } = spawnSync(binary(), words, { env, encoding: "utf8" });
  if (status !== 0) throw new Error(`rafcon ${words.join(" ")}: ${stderr}`);
  return stdout.trim().split("\n");
}

/** Names of the innermost active states: one a branch. */
export function innermost({ active }: Moment): readonly string[] {
  return active
    .filter(({ path }) => !active.some((other) => other.path.startsWith(`${path}/`)))
    .map(({ names }) => names.split("/").at(-1) ?? "")
    .sort();
}

/** The ruler of the time line, on the screen. */
export async function ruler(app: App): Promise<{ x: number; y: number; width: number }> {
  const box = await app.sheet.locator(".timeline-ruler").boundingBox();
  if (!box) throw new Error("there is no time line");
  return { x: box.x, y: box.y + 8, width: box.width };
}
