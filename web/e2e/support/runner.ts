/** The program of a run, as a process of its own: stopped in the middle of whatever it does, and let go on. */

import { readdirSync, readlinkSync } from "node:fs";
import { join } from "node:path";
import type { Server } from "./server.ts";

/** The processes that have a file open in the folder of the run, but for the server. */
export function runnersOf(server: Server, run: string): readonly number[] {
  const folder = join(server.place.folder, "runs", run);
  const found = readdirSync("/proc").filter((pid) => /^\d+$/.test(pid) && holds(pid, folder));
  return found.map(Number).filter((pid) => pid !== server.pid);
}

/** Does something while the program of the run hears nothing and says nothing. */
export async function whileStopped(
  server: Server,
  run: string,
  act: () => Promise<void>,
): Promise<void> {
  const runners = runnersOf(server, run);
  if (runners.length !== 1) throw new Error(`${run} has ${runners.length} programs`);
  for (const pid of runners) process.kill(pid, "SIGSTOP");
  try {
    await act();
  } finally {
    for (const pid of runners) process.kill(pid, "SIGCONT");
  }
}

/** Whether a process has a file open in the folder. */
function holds(pid: string, folder: string): boolean {
  try {
    const files = readdirSync(`/proc/${pid}/fd`);
    return files.some((file) => readlinkSync(`/proc/${pid}/fd/${file}`).startsWith(folder));
  } catch {
    // It ended by itself, or it is somebody else's.
    return false;
  }
}
