/** A robot and a station over each of the links in `links.json`, for some minutes each: what an event costs, how late it is, and how
 * soon the station is live after the link was silent and its modem then sends what it held. Programs, clocks and sockets are real. */

import { setTimeout as pass } from "node:timers/promises";
import { Camp, newMission } from "./camp.ts";
import links from "./links.json" with { type: "json" };
import { type Figure, type Followed, headAt, quantile, shown, within } from "./measures.ts";
import { newValues } from "./values.ts";
import { cutWebSocket } from "./websocket.ts";

type Link = (typeof links)[number];

/** Missions of the reference's users have about so many states. */
const STATES = 750;
const EVENTS_PER_S = 5;
/** The station is live, and has the machine, before anything is measured. */
const SETTLE_MS = 30_000;
/** After a cut everything is here at the latest. */
const RETURN_MS = 40_000;
const PATIENCE_MS = 180_000;

/** The figures of the links with these names, separated by commas; of all if there are none. */
export async function overLinks(names: string): Promise<readonly Figure[]> {
  const wanted = names.split(",").filter((name) => name !== "");
  const unknown = wanted.find((name) => !links.some((link) => link.name === name));
  if (unknown !== undefined) throw new Error(`there is no link ${unknown} in links.json`);
  const found: Figure[] = [];
  for (const link of links) {
    if (wanted.length > 0 && !wanted.includes(link.name)) continue;
    process.stderr.write(`${link.name} …\n`);
    found.push(...(await over(link)));
  }
  return found;
}

async function over(link: Link): Promise<readonly Figure[]> {
  if (link.carrier === "websocket") return overWebSocket(link);
  const camp = await Camp.pitch({
    hasSeveral: false,
    profile: link.profile,
    path: pathOf(link),
    machine: (folder) =>
      link.machine === "values" ? newValues(folder) : newMission(folder, EVENTS_PER_S, STATES),
    inputs: link.machine === "values" ? {} : { time_scale: 0 },
  });
  try {
    return await measured(camp, link);
  } catch (error) {
    process.exitCode = 1;
    throw error;
  } finally {
    await camp.strike();
  }
}

function pathOf({ path }: Link): readonly string[] {
  return Object.entries(path).flatMap(([word, value]) => [`--${word}`, String(value)]);
}

async function overWebSocket(link: Link): Promise<readonly Figure[]> {
  const { returns, followed } = await cutWebSocket({
    profile: link.profile,
    path: pathOf(link),
    eventsPerSecond: EVENTS_PER_S,
    states: STATES,
    settle_ms: SETTLE_MS + link.seconds * 1_000,
    cut_s: link.cut_s ?? [],
    return_ms: RETURN_MS,
  });
  const end = (returns[0] ?? 0) - (link.cut_s?.[0] ?? 0) * 1_000;
  const whole = { from: end - link.seconds * 1_000, to: end };
  return figuresOf(link, { whole, bytes: 0, returns, followed });
}

async function measured(camp: Camp, link: Link): Promise<readonly Figure[]> {
  const { host } = camp.ground;
  const [observer, anna] = [camp.operator("observer", camp.robot), camp.operator("anna", host)];
  const isThere = await camp.until(host, ({ snapshot }) => snapshot !== null, PATIENCE_MS);
  if (!isThere) throw new Error(`no run came over ${link.name}`);
  await pass(SETTLE_MS);
  const [from, before] = [Date.now(), await camp.sent()];
  await pass(link.seconds * 1_000);
  const whole = { from, to: Date.now() };
  const bytes = (await camp.sent()) - before;
  const returns: number[] = [];
  for (const seconds of link.hold_s ?? []) {
    await camp.link("hold");
    await pass(seconds * 1_000);
    await camp.link("mend");
    returns.push(Date.now());
    await pass(RETURN_MS);
  }
  process.stderr.write(host.say(["link"]) + camp.robot.say(["link"]));
  anna.command({ type: "stop" }, null);
  await camp.until(host, ({ run }) => run.phase === "finished", PATIENCE_MS);
  await pass(1_000);
  const [noted, seen] = [await observer.notes(), await anna.notes()];
  for (const one of [observer, anna]) one.end();
  const followed = shown({ robotJournal: camp.history(camp.robot), observer: noted }, seen);
  return figuresOf(link, { whole, bytes, returns, followed });
}

interface Measured {
  readonly whole: { readonly from: number; readonly to: number };
  readonly bytes: number;
  /** When the link came back each time. */
  readonly returns: readonly number[];
  readonly followed: Followed;
}

function figuresOf(link: Link, { whole, bytes, returns, followed }: Measured): readonly Figure[] {
  const { happened, seen } = followed;
  const delay_ms = link.path.delay;
  const events = within(happened, [whole]);
  const late = events.map((at) => (seen[at] ?? 0) - (happened[at] ?? 0) - delay_ms);
  const live = returns.map((to) => (seen[headAt(happened, to)] ?? 0) - to - delay_ms);
  const figures: Figure[] = [
    { name: `${link.name}_events`, value: events.length, unit: "", bar: null },
    {
      name: `${link.name}_latency_p50_s`,
      value: quantile(late, 0.5) / 1_000,
      unit: "s",
      bar: null,
    },
  ];
  for (const [name, bar] of Object.entries(link.bars)) {
    if (name.includes("bytes"))
      figures.push({ name, value: bytes / events.length, unit: "B", bar });
    else if (name.startsWith("latency"))
      figures.push({ name, value: quantile(late, 0.99) / 1_000, unit: "s", bar });
    else figures.push({ name, value: Math.max(...live) / 1_000, unit: "s", bar });
  }
  return figures;
}
