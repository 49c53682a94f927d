/** A robot whose station is reached by a WebSocket alone, on two hosts with real kernels: how soon the station is live after a silent cut.
 * TCP waits longer with each try in a cut. It needs root. */

import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { setTimeout as pass } from "node:timers/promises";
import { binary } from "../../e2e/support/places.ts";
import { BadLink } from "./bad_link.ts";
import { newMission } from "./camp.ts";
import { Host, owned, type Where } from "./host.ts";
import { type Followed, type Kept, shown } from "./measures.ts";
import { Operator } from "./operator.ts";

const NAME = "rafconws";
/** The proxy's address of the station. */
const STATION = "10.48.0.2:4748";
const PATIENCE_MS = 180_000;

export interface WebSocketCut {
  readonly profile: string;
  /** Options of the bad network. */
  readonly path: readonly string[];
  readonly eventsPerSecond: number;
  readonly states: number;
  readonly settle_ms: number;
  readonly cut_s: readonly number[];
  readonly return_ms: number;
}

/** When the link came back each time, and what the station showed. */
export async function cutWebSocket(
  wanted: WebSocketCut,
): Promise<{ readonly returns: readonly number[]; readonly followed: Followed }> {
  const folder = mkdtempSync(join(tmpdir(), "rafcon-ws-"));
  const link = await BadLink.ofHosts(NAME, wanted.path);
  const mission = join(folder, "missions/mission");
  newMission(mission, wanted.eventsPerSecond, wanted.states);
  const ways = ["--link", wanted.profile];
  const serve = ["serve", join(folder, "missions"), "--station", `ws://${STATION}`, ...ways];
  const robot = new Host("robot", join(folder, "robot"), serve, on("robot"));
  const station = ["station", "--listen", STATION, ...ways];
  const ground = new Host("ground", join(folder, "ground"), station, on("station"));
  try {
    ground.say(["pair", "--paste"], robot.say(["pair", "scout"]));
    await ground.begin();
    await robot.begin();
    const runner = begin(robot, mission);
    const run = await firstRun(robot.runs);
    const [observer, anna] = [operator("observer", robot, run), operator("anna", ground, run)];
    await untilThere(ground.runs, run);
    await pass(wanted.settle_ms);
    const returns: number[] = [];
    for (const seconds of wanted.cut_s) {
      await link.say("cut");
      await pass(seconds * 1_000);
      await link.say("mend");
      returns.push(Date.now());
      await pass(wanted.return_ms);
    }
    const [noted, seen] = [await observer.notes(), await anna.notes()];
    for (const one of [observer, anna]) one.end();
    runner.kill("SIGKILL");
    return {
      returns,
      followed: shown({ robotJournal: history(robot, run), observer: noted }, seen),
    };
  } finally {
    await robot.end();
    await ground.end();
    await link.end();
    rmSync(folder, { recursive: true, force: true, maxRetries: 5 });
  }
}

/** Its servers listen on the loopback of the host, where its operators are, too. */
function on(host: string): Where {
  return { inside: ["ip", "netns", "exec", `${NAME}-${host}`], address: "127.0.0.1" };
}

function begin(robot: Host, mission: string) {
  const words = ["run", mission, "--input", "time_scale=0"];
  return owned(spawn(binary(), words, { env: robot.env, stdio: "ignore" }));
}

function operator(name: string, host: Host, run: string): Operator {
  return new Operator({ name, url: host.url, token: host.user(name), run }, host);
}

async function firstRun(runs: string): Promise<string> {
  for (;;) {
    const found = existsSync(runs) ? readdirSync(runs)[0] : undefined;
    if (found) return found;
    await pass(100);
  }
}

async function untilThere(runs: string, run: string): Promise<void> {
  const end = Date.now() + PATIENCE_MS;
  while (!existsSync(join(runs, run))) {
    if (Date.now() > end) throw new Error("no run came over the WebSocket");
    await pass(100);
  }
}

function history(host: Host, run: string): readonly Kept[] {
  const lines = host.say(["history", run, "--json", "--values"]).trimEnd().split("\n");
  return lines.map((line) => JSON.parse(line) as Kept);
}
