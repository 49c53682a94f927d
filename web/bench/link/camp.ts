/** The place of the scenario: a robot, its stations, the bad network between them, a mission that runs, and who looks on. */

import { spawnSync } from "node:child_process";
import { createSocket } from "node:dgram";
import { once } from "node:events";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { setTimeout as pass } from "node:timers/promises";
import { binary } from "../../e2e/support/places.ts";
import type { RunNow } from "../../src/model/generated/protocol.ts";
import { makeEndless } from "../endless.ts";
import { BadLink } from "./bad_link.ts";
import { Host } from "./host.ts";
import type { Kept } from "./measures.ts";
import { Operator } from "./operator.ts";

/** The stations of a robot with several; the last one comes late. */
const NAMES = ["near", "far", "late"] as const;

/** What is built up. */
export interface Plan {
  /** Whether there are three stations, of which one is not there yet, or one. */
  readonly hasSeveral: boolean;
  /** The profile of the link on both sides. */
  readonly profile: string;
  /** What the bad network is from the beginning, as words of its command line. */
  readonly path: readonly string[];
  /** Makes the machine that runs, in a folder that is not there yet. */
  readonly machine: (folder: string) => void;
  /** The inputs of the run. */
  readonly inputs: Readonly<Record<string, unknown>>;
}

/** A station, and the way to it. */
export interface Ground {
  readonly host: Host;
  readonly link: BadLink;
}

export class Camp {
  readonly folder: string;
  readonly robot: Host;
  readonly grounds: readonly Ground[];
  readonly run: string;

  private constructor(folder: string, robot: Host, grounds: readonly Ground[], run: string) {
    [this.folder, this.robot, this.grounds, this.run] = [folder, robot, grounds, run];
  }

  /** Builds it up, and begins the run. */
  static async pitch({ hasSeveral, profile, path, machine, inputs }: Plan): Promise<Camp> {
    const folder = mkdtempSync(join(tmpdir(), "rafcon-camp-"));
    const missions = join(folder, "missions");
    machine(join(missions, "mission"));
    const grounds: Ground[] = [];
    for (const name of hasSeveral ? NAMES : NAMES.slice(0, 1)) {
      grounds.push(await ground(folder, name, profile, path));
    }
    const links = grounds.flatMap(({ host, link }) => {
      return ["--station", hasSeveral ? `${host.name}=${link.address}` : link.address];
    });
    const words = ["serve", missions, ...links, "--link", profile];
    const robot = new Host("robot", join(folder, "robot"), words);
    for (const { host } of grounds) {
      const line = robot.say(["pair", "scout", ...(hasSeveral ? ["--station", host.name] : [])]);
      host.say(["pair", "--paste"], line);
    }
    for (const { host } of grounds.slice(0, 2)) await host.begin();
    await robot.begin();
    const [project] = await robot.ask<{ id: string }[]>("GET", "/projects");
    const { id } = await robot.ask<{ id: string }>("POST", "/runs", {
      id: "camp",
      machine: { project: project?.id, path: "mission" },
      inputs,
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
    const post = { name, url: host.url, token: host.user(name), run: this.run };
    return new Operator(post, host);
  }

  /** From one operator to another, at their stations: the offer is accepted once it is known there. */
  async passControl(from: Operator, to: Operator): Promise<void> {
    const path = `/runs/${this.run}/control`;
    const name = to.host === from.host ? to.name : `${to.name}@${to.host.name}`;
    // A robot's server that has begun again knows nobody who is in control.
    await from.host.ask("POST", path, { move: "request" }, from.token).catch(() => undefined);
    await from.host.ask("POST", path, { move: "hand_over", to: name }, from.token);
    const isOffered = await this.until(
      to.host,
      ({ control }) => control.offered_to !== undefined,
      15_000,
    );
    if (!isOffered) process.stderr.write(`${to.name} was offered nothing\n`);
    await to.host.ask("POST", path, { move: "accept" }, to.token);
  }

  /** Changes the link to all stations. */
  async link(words: string): Promise<void> {
    await Promise.all(this.grounds.map(({ link }) => link.say(words)));
  }

  /** What the robot has sent to the first station so far, in bytes. */
  async sent(): Promise<number> {
    return (await this.ground.link.say("say")).down.bytes;
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
    for (const host of [this.robot, ...this.grounds.map((ground) => ground.host)]) await host.end();
    if (process.exitCode) process.stderr.write(`what was left is in ${this.folder}\n`);
    else rmSync(this.folder, { recursive: true, force: true, maxRetries: 5 });
  }
}

/** An endless mission with this number of states, and this number of changes a second. */
export function newMission(folder: string, rate: number, states = 800): void {
  const words = ["new", "--template", "mission", "--states", String(states), folder];
  const made = spawnSync(binary(), words);
  if (made.status !== 0) throw new Error(`no mission was made: ${made.stderr}`);
  makeEndless(folder, rate);
}

async function ground(
  folder: string,
  name: string,
  profile: string,
  path: readonly string[],
): Promise<Ground> {
  const address = `127.0.0.1:${await freePort()}`;
  const words = ["station", "--listen", address, "--link", profile];
  const host = new Host(name, join(folder, name), words);
  return { host, link: await BadLink.to(address, path) };
}

async function freePort(): Promise<number> {
  const socket = createSocket("udp4").bind(0, "127.0.0.1");
  await once(socket, "listening");
  const { port } = socket.address();
  socket.close();
  return port;
}
