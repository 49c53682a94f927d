/** What a page at a station is compared with: a page on the far side of the bad link, over a network of two hosts with real kernels.
 * It needs root. */

import { spawn } from "node:child_process";
import { chmodSync, existsSync, mkdtempSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { setTimeout as pass } from "node:timers/promises";
import { type Browser, chromium, errors } from "playwright-core";
import { binary } from "../../e2e/support/places.ts";
import { BadLink } from "./bad_link.ts";
import { newMission } from "./camp.ts";
import { Host, owned } from "./host.ts";

const NAME = "rafconfar";
const [USER, PASSWORD] = ["anna", "a password for the far side"];
/** Whoever waits longer gives up. */
const PATIENCE_MS = 300_000;

/** The ms until the page shows the run; null if it does not in five minutes. */
export async function farPageLive(bitsPerSecond: number, rate: number): Promise<number | null> {
  const folder = mkdtempSync(join(tmpdir(), "rafcon-far-"));
  const link = await BadLink.ofHosts(NAME, ["--down", String(bitsPerSecond)]);
  const mission = join(folder, "missions/mission");
  newMission(mission, rate);
  const inside = ["ip", "netns", "exec", `${NAME}-robot`];
  const where = { inside, address: "10.48.0.1" };
  const robot = new Host("robot", folder, ["serve", join(folder, "missions")], where);
  try {
    robot.say(["user", "add", USER, "--role", "operator"], `${PASSWORD}\n`);
    await robot.begin();
    const state = join(folder, "state");
    const env = { ...process.env, RAFCON_STATE: state, RAFCON_RUNS: robot.runs };
    const words = ["run", mission, "--input", "time_scale=0"];
    const runner = owned(spawn(binary(), words, { env, stdio: "ignore" }));
    const run = await firstRun(robot.runs);
    const took = await visit(robot, run);
    runner.kill("SIGKILL");
    return took;
  } finally {
    await robot.end();
    await link.end();
    rmSync(folder, { recursive: true, force: true, maxRetries: 5 });
  }
}

async function firstRun(runs: string): Promise<string> {
  for (;;) {
    const found = existsSync(runs) ? readdirSync(runs)[0] : undefined;
    if (found) return found;
    await pass(100);
  }
}

/** A browser at the other host. */
function farBrowser(folder: string): Promise<Browser> {
  const wrapper = join(folder, "browser");
  const browser = process.env["RAFCON_CHROMIUM"] ?? "/usr/bin/chromium";
  writeFileSync(wrapper, `#!/bin/sh\nexec ip netns exec ${NAME}-station ${browser} "$@"\n`);
  chmodSync(wrapper, 0o755);
  return chromium.launch({ executablePath: wrapper, args: ["--no-sandbox", "--disable-gpu"] });
}

async function visit(robot: Host, run: string): Promise<number | null> {
  const browser = await farBrowser(robot.folder);
  try {
    const context = await browser.newContext({ ignoreHTTPSErrors: true });
    context.setDefaultTimeout(PATIENCE_MS);
    await context.addInitScript("window.__rafcon = null");
    const sheet = await context.newPage();
    const begun = performance.now();
    await sheet.goto(`${robot.url}/?layout=mission&run=${run}`, { waitUntil: "commit" });
    await sheet.getByLabel("User").fill(USER);
    await sheet.getByLabel("Password").fill(PASSWORD);
    await sheet.keyboard.press("Enter");
    await sheet.waitForFunction(
      (id) => {
        const shown = window.__rafcon?.page.active.value?.run.value;
        return shown?.id === id && shown.now.value?.snapshot != null;
      },
      run,
      { timeout: PATIENCE_MS - (performance.now() - begun), polling: 100 },
    );
    return performance.now() - begun;
  } catch (error) {
    if (error instanceof errors.TimeoutError) return null;
    throw error;
  } finally {
    await browser.close();
  }
}
