/** Runs whose program is killed in the middle, as a fault in a driver does. */

import { expect, vi } from "vitest";
import type { Moment } from "../../src/model/generated/protocol.ts";
import type { App } from "./app.ts";
import { PATIENCE } from "./patience.ts";
import { runnersOf } from "./runner.ts";
import { runInFront, untilActive } from "./runs.ts";
import type { Server } from "./server.ts";

/** Kills the program of the run in front once the state is active and has said that it works, by this global variable. */
export async function crashIn(
  app: App,
  server: Server,
  path: string,
  variable: string,
): Promise<void> {
  await untilActive(app, path);
  const run = await runInFront(app);
  await untilSet(server, run, variable);
  const runners = runnersOf(server, run);
  expect(runners.length).toBe(1);
  for (const pid of runners) process.kill(pid, "SIGKILL");
}

/** Waits until the run is known to have set a global variable. */
async function untilSet(server: Server, run: string, variable: string): Promise<void> {
  await vi.waitUntil(async () => {
    const { globals } = await server.ask<Moment>("GET", `/runs/${run}/moments`);
    return variable in globals;
  }, PATIENCE);
}
