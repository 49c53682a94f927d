// @vitest-environment happy-dom
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { LinkHealth } from "../../model/generated/protocol.ts";
import { runLine, STARTED_MS, watched } from "../../store/testing/watched.ts";
import { settled, unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { RobotLink } from "./robot_link.tsx";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  unmount();
  vi.useRealTimers();
});

const WHOLE: LinkHealth = {
  robot: "scout",
  is_heard: true,
  heard_ms: STARTED_MS + 59_700,
  expected_every_ms: 500,
  reached_ms: STARTED_MS + 57_000,
  round_trip_ms: 4_100,
  lifetime_ms: 22_300,
  command_bytes_per_s: 2_000,
  down_bytes_per_s: 5_200,
  up_bytes_per_s: 31,
  missing: 0,
  commands: [{ id: "ana/1", asks: "pause", stage: "sent", sent_ms: STARTED_MS, arrives_ms: null }],
  clock: { least_ms: -200, most_ms: 3_900 },
  rights: "command",
};

/** Texts about a link a minute after the run began, one fact a line. */
async function shownFor(
  robot?: LinkHealth,
  phase: "live" | "crashed" | "finished" = "live",
): Promise<readonly string[]> {
  vi.setSystemTime(STARTED_MS + 60_000);
  const { watch } = watched(runLine(phase), robot ? { robot } : {});
  const place = shown(<RobotLink watch={watch} />, { watch });
  await settled();
  const facts = [...place.querySelectorAll("dl div")].map(
    (fact) => `${fact.querySelector("dt")?.textContent}: ${fact.querySelector("dd")?.textContent}`,
  );
  const contact = place.querySelector("p")?.textContent;
  return contact === undefined ? [] : [contact, ...facts];
}

test("nothing is said of the link of a run that is not far away", async () => {
  expect(await shownFor()).toEqual([]);
});

test("nothing is said of the link of a run that is over: it was told while the run went on", async () => {
  expect(await shownFor(WHOLE, "finished")).toEqual([]);
  expect(await shownFor(WHOLE, "crashed")).toEqual([]);
});

test("a whole link says its delay, its rates, what is on the way and how the clocks differ", async () => {
  expect(await shownFor(WHOLE)).toEqual([
    "Receiving from scout",
    "delay: 2.0 s",
    "command given now: effect in 2.0 s, expires in 22 s",
    "planned contact: no contact planned",
    "next status: within 0.5 s",
    "received / sent: 5.2 KB/s / 31 B/s",
    "events to come: none",
    "commands on the way: 1",
    "clock ahead by: +1.9 s ± 2.0 s",
    "this station may: command runs",
  ]);
});

test("in a blackout its length is shown, and that the next status is unknown", async () => {
  const dark = { ...WHOLE, is_heard: false, heard_ms: STARTED_MS, reached_ms: STARTED_MS };
  expect(await shownFor({ ...dark, missing: 1_204 })).toEqual([
    "No signal from scout for 1:00",
    "delay: 2.0 s, 1:00 ago",
    "command given now: effect unknown: no contact with the robot, expires in 22 s",
    "planned contact: no contact planned",
    "next status: unknown",
    "received / sent: 5.2 KB/s / 31 B/s",
    "events to come: 1,204 or more",
    "commands on the way: 1",
    "clock ahead by: +1.9 s ± 2.0 s",
    "this station may: command runs",
  ]);
});

test("in a blackout nobody knows what has happened since", async () => {
  const dark = { ...WHOLE, is_heard: false, heard_ms: STARTED_MS };
  expect(await shownFor(dark)).toContain("events to come: unknown");
});

test("a dead up-link is as visible as a dead down-link", async () => {
  const [contact] = await shownFor({ ...WHOLE, reached_ms: STARTED_MS + 33_000 });
  expect(contact).toBe("Receiving from scout, but it has confirmed nothing from here for 27 s");
});

test("what is unknown for want of an up-link is said to be", async () => {
  const clock = { least_ms: 40, most_ms: null };
  const facts = await shownFor({ ...WHOLE, reached_ms: null, round_trip_ms: null, clock });
  expect(facts.filter((fact) => /^(delay|clock)/.test(fact))).toEqual([
    "delay: unknown: no up-link",
    "clock ahead by: +40 ms or more",
  ]);
});

test("what users of the station may do on the robot is shown, as far as it is known", async () => {
  const may = async (rights: LinkHealth["rights"]) =>
    (await shownFor({ ...WHOLE, rights } as LinkHealth)).at(-1);
  expect(await may("observe")).toBe("this station may: see runs");
  unmount();
  expect(await may("change")).toBe("this station may: command and change runs");
  unmount();
  expect(await may(undefined)).toBe("this station may: unknown");
});

const MINUTE_MS = 60_000;
/** Time at which the link is shown. */
const NOW_MS = STARTED_MS + MINUTE_MS;

/** The facts about planned contacts, then the commands on the way. */
async function plannedFor(robot: Partial<LinkHealth>): Promise<readonly string[]> {
  const all = await shownFor({ ...WHOLE, ...robot });
  const commands = [...document.querySelectorAll(".robot-link-commands li")];
  const facts = all.filter((fact) => /^(command given now|planned contact)/.test(fact));
  return [...facts, ...commands.map((line) => line.textContent ?? "")];
}

test("the next contact is shown, and when a command is sent and takes effect", async () => {
  const begin_ms = NOW_MS + 80 * MINUTE_MS;
  const contact = { begin_ms, end_ms: begin_ms + 20 * MINUTE_MS, profile: "deep", note: "Kiruna" };
  const queued = { asks: "pause", stage: "sent", sent_ms: NOW_MS, send_at_ms: begin_ms } as const;
  const commands = [
    { ...queued, id: "ana/1", arrives_ms: begin_ms + 2_050, effect_ms: begin_ms + 2_050 },
    { ...queued, id: "bo/1", asks: "start_run", arrives_ms: null },
  ];
  expect(await plannedFor({ contact, commands })).toEqual([
    "command given now: sent in 1:20:00, effect in 1:20:02, expires in 1:20:24",
    "planned contact: in 1:20:00, 01:37:40 UTC to 01:57:40 UTC, profile deep, Kiruna",
    "Pause of ana: to be sent in 1:20:00, at 01:37:40 UTC, takes effect in 1:20:02, at 01:37:42 UTC",
    "Start a run of bo: to be sent in 1:20:00, at 01:37:40 UTC, time of effect unknown: delay not measured yet",
  ]);
});

test("in an open contact its end is shown, and commands are sent at once", async () => {
  const contact = { begin_ms: NOW_MS - 1, end_ms: NOW_MS + 20 * MINUTE_MS, profile: "deep" };
  const states = [
    { stage: "sent", effect_ms: NOW_MS + 2_000 },
    { stage: "sent", effect_ms: NOW_MS - 1 },
    { stage: "received", effect_ms: NOW_MS + MINUTE_MS },
    { stage: "received" },
    { stage: "started" },
    { stage: "overdue" },
  ] as const;
  const way = { asks: "pause", sent_ms: NOW_MS, arrives_ms: null };
  const commands = states.map((state, nth) => ({ ...way, ...state, id: `ana/${nth}` }));
  expect(await plannedFor({ contact, commands })).toEqual([
    "command given now: effect in 2.0 s, expires in 22 s",
    "planned contact: open until 00:37:40 UTC, 20:00 left, profile deep",
    "Pause of ana: being sent, takes effect in 2.0 s, at 00:17:42 UTC",
    "Pause of ana: being sent, should have taken effect, no answer yet",
    "Pause of ana: the robot has it, takes effect in 1:00, at 00:18:40 UTC",
    "Pause of ana: the robot has it",
    "Pause of ana: the run has it",
    "Pause of ana: expired without an answer of the robot",
  ]);
});

test("an unreadable plan is not shown as no contact", async () => {
  const facts = await plannedFor({
    contacts_problem: "damaged",
    round_trip_ms: null,
    commands: [],
  });
  expect(facts).toEqual([
    "command given now: effect unknown: delay not measured yet, expires in 22 s",
    "planned contact: unknown: the plan cannot be read",
  ]);
});

test("without contact a command that is being sent has no time of effect", async () => {
  const way = {
    asks: "pause",
    stage: "sent",
    sent_ms: NOW_MS,
    arrives_ms: NOW_MS + 2_000,
  } as const;
  const commands = [{ ...way, id: "ana/1", effect_ms: NOW_MS + 2_000 }];
  expect(await plannedFor({ is_heard: false, commands })).toEqual([
    "command given now: effect unknown: no contact with the robot, expires in 22 s",
    "planned contact: no contact planned",
    "Pause of ana: being sent, time of effect unknown: no contact with the robot",
  ]);
});
