/** The place of the scenario: a robot, its stations, the bad network between them, a mission that runs, and who looks on. */

import { spawnSync } from "node:child_process";
import { createSocket } from "node:dgram";
import { once } from "node:events";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { setTimeout as pass } from "node:timers/promises";
import { binary } from "../../e2e/support/places.ts";
import type { ControlMove, RunNow } from "../../src/model/generated/protocol.ts";
import { makeEndless } from "../endless.ts";
import { BadLink } from "./bad_link.ts";
import { Host } from "./host.ts";
import type { Kept } from "./measures.ts";
import { Operator } from "./operator.ts";

const STATES = "800";
/** The command line takes so many `--station`s; with an older program there is one station. */
export type Stations = 1 | 2;

/** A station, and the way to it. */
export interface Ground {
  readonly host: Host;
  readonly proxy: BadLink;
}

export class Camp {
  readonly folder: string;
  readonly robot: Host;
  readonly grounds: readonly Ground[];
  readonly run: string;

  private constructor(folder: string, robot: Host, grounds: readonly Ground[], run: string) {
    [this.folder, this.robot, this.grounds, this.run] = [folder, robot, grounds, run];
  }

  /** Builds it up; so many events happen in a second. */
  static async pitch(stations: Stations, rate: number): Promise<Camp> {
    const folder = mkdtempSync(join(tmpdir(), "rafcon-camp-"));
    const missions = join(folder, "missions");
    newMission(join(missions, "mission"), rate);
    const grounds: Ground[] = [];
    for (let number = 1; number <= stations; number += 1)
      grounds.push(await ground(folder, number));
    const links = grounds.flatMap(({ proxy }) => ["--station", proxy.address]);
    const words = ["serve", missions, ...links, "--link", "delay-2s"];
    const robot = new Host("robot", join(folder, "robot"), words);
    for (const { host } of grounds) pair(robot, host);
    for (const { host } of grounds) await host.begin();
    await robot.begin();
    const [project] = await robot.ask<{ id: string }[]>("GET", "/projects");
    const machine = { project: project?.id, path: "mission" };
    const { id } = await robot.ask<{ id: string }>("POST", "/runs", {
      id: "camp",
      machine,
      inputs: { time_scale: 0 },
    });
    return new Camp(folder, robot, grounds, id);
  }

  /** The first station; it is there from the beginning. */
  get ground(): Ground {
    const [first] = this.grounds;
    if (!first) throw new Error("there is no station");
    return first;
  }

  /** Somebody who looks on at a computer. */
  operator(name: string, host: Host): Operator {
    return new Operator({ name, url: host.url, token: host.user(name), run: this.run });
  }

  /** From one operator to another at a station, by an offer that is accepted. */
  async passControl(from: Operator, to: Operator, at: Host): Promise<void> {
    const move = (token: string, wanted: ControlMove) =>
      at.ask("POST", `/runs/${this.run}/control`, wanted, token);
    await move(from.token, { move: "hand_over", to: to.name });
    await move(to.token, { move: "accept" });
  }

  /** Changes the link to all stations. */
  async link(words: string): Promise<void> {
    await Promise.all(this.grounds.map(({ proxy }) => proxy.say(words)));
  }

  /** What the robot has sent to the first station so far, in bytes. */
  async sent(): Promise<number> {
    return (await this.ground.proxy.say("say")).down.bytes;
  }

  /** Waits until a server says of the run what is wanted. */
  async until(host: Host, wanted: (now: RunNow) => boolean, patience_ms: number): Promise<boolean> {
    const end = Date.now() + patience_ms;
    while (Date.now() < end) {
      const now = await host.ask<RunNow>("GET", `/runs/${this.run}`).catch(() => null);
      if (now && wanted(now)) return true;
      await pass(100);
    }
    return false;
  }

  /** All events with their values, as a computer has them on disk. */
  history(host: Host): readonly Kept[] {
    const lines = host.say(["history", this.run, "--json", "--values"]).trimEnd().split("\n");
    return lines.map((line) => JSON.parse(line) as Kept);
  }

  async strike(): Promise<void> {
    for (const host of [this.robot, ...this.grounds.map((ground) => ground.host)])
      await host.kill();
    if (process.exitCode) process.stderr.write(`what was left is in ${this.folder}\n`);
    else rmSync(this.folder, { recursive: true, force: true, maxRetries: 5 });
  }
}

function newMission(folder: string, rate: number): void {
  const words = ["new", "--template", "mission", "--states", STATES, folder];
  const made = spawnSync(binary(), words);
  if (made.status !== 0) throw new Error(`no mission was made: ${made.stderr}`);
  makeEndless(folder, rate);
}

async function ground(folder: string, number: number): Promise<Ground> {
  const address = `127.0.0.1:${await freePort()}`;
  const words = ["station", "--listen", address, "--link", "delay-2s"];
  const host = new Host(`station ${number}`, join(folder, `station-${number}`), words);
  return { host, proxy: await BadLink.to(address) };
}

async function freePort(): Promise<number> {
  const socket = createSocket("udp4").bind(0, "127.0.0.1");
  await once(socket, "listening");
  const { port } = socket.address();
  socket.close();
  return port;
}

function pair(robot: Host, station: Host): void {
  const line = robot.say(["pair", "scout"]);
  station.say(["pair", "--paste"], line);
}
