/** Formats points in time on the scale of the settings, which each text names. A run uses the clock of its robot. For a remote
 * robot, UTC is as precise as the known offset of its clock. */

import { signal } from "@preact/signals-core";
import type { ClockOffset, RunSummary } from "../../model/generated/protocol.ts";
import type { Watch } from "../history/run.ts";

/** Time since the start of a run, UTC, the robot's clock, or the time zone of this browser. */
export type TimeScale = "mission" | "utc" | "robot" | "local";

export const TIME_SCALES: readonly { readonly value: TimeScale; readonly title: string }[] = [
  { value: "mission", title: "Since the start of the run (T+)" },
  { value: "utc", title: "UTC" },
  { value: "robot", title: "The robot's clock" },
  { value: "local", title: "Time zone of this computer" },
];

/** Scale in this browser's settings. */
export const timeScale = signal<TimeScale>("mission");

const SECOND = 1_000;
const MINUTE = 60 * SECOND;
const HOUR = 60 * MINUTE;
const DAY = 24 * HOUR;

/** `14:03:27 UTC` or `15:03:27 CET`, with the date if it is not today. Without a run there is no mission time; local time is used
 * instead. */
export function wallTime(at_ms: number, now_ms: number): string {
  const isThisYear = now_ms - at_ms < 300 * DAY;
  const date = dateOf(at_ms, isThisYear);
  return date === dateOf(now_ms, true) ? clock(at_ms, 0) : `${date} ${clock(at_ms, 0)}`;
}

/** `14:03:27 UTC`, with the date if it is not today in UTC. */
export function utcTime(at_ms: number, now_ms: number): string {
  const [date, time] = new Date(at_ms).toISOString().slice(0, 19).split("T");
  return new Date(now_ms).toISOString().startsWith(`${date}`)
    ? `${time} UTC`
    : `${date} ${time} UTC`;
}

/** Start time of a run. For a robot's run by the robot's clock, because its offset is unknown here. */
export function startedAt({ started_ms, robot }: Pick<RunSummary, "started_ms" | "robot">): string {
  const time = wallTime(started_ms, Date.now());
  return robot === undefined ? time : `${time} by ${robot}’s clock`;
}

/** A time of a run at the resolution of `step_ms`: `T+12.345 s`, `T+1:02:03.5`, `14:03:27.345 UTC`, `14:03:27.345 by scout`. A
 * crash stops the clock of a run; after it only mission time is known. */
export function runTime(watch: Watch, t_ns: number, step_ms = 1): string {
  const at = dayTimesOf(watch, t_ns);
  const scale = timeScale.value;
  if (scale === "mission" || at === null) return missionTime(t_ns, step_ms);
  const digits = digitsOf(step_ms);
  if (scale === "robot" || at.utc === null) return robotClock(at, digits);
  return `${at.utc.isLatest ? "≤ " : ""}${clock(at.utc.at_ms, digits, scale)}`;
}

/** A time of a run on all scales, one per line. */
export function runTimes(watch: Watch, t_ns: number): string {
  const at = dayTimesOf(watch, t_ns);
  const times: string[] = [];
  if (at?.utc) times.push(bounded(at.utc, 3, "utc"), bounded(at.utc, 3, "local"));
  if (at?.robot) times.push(robotClock(at, 3));
  return [missionTime(t_ns), ...new Set(times)].join("\n");
}

/** A time of a run by the clocks, to the second: UTC with its error bound, and for a remote robot its own clock. */
export interface ClockTimes {
  readonly utc: string;
  /** Empty unless the robot is remote. */
  readonly robot: string;
}

/** Null if a crash has stopped the clock of the run. */
export function clockTimes(watch: Watch, t_ns: number): ClockTimes | null {
  const at = dayTimesOf(watch, t_ns);
  if (at === null) return null;
  const utc = at.utc === null ? "unknown" : bounded(at.utc, 0, "utc").replace(" UTC", "");
  return { utc, robot: at.robot === null ? "" : clock(at.robot_ms, 0, "utc").replace(" UTC", "") };
}

/** A time since the start of a run, like a clock: `T+00:12:34`. */
export function missionClock(ms: number): string {
  const [hours, minutes] = [Math.floor(ms / HOUR), Math.floor(ms / MINUTE) % 60];
  return `T+${two(hours)}:${two(minutes)}:${two(Math.floor(ms / SECOND) % 60)}`;
}

/** A time since the start of the run: `T+12.345 s`. */
export function missionTime(t_ns: number, step_ms = 1): string {
  return `T+${sinceStart(t_ns / 1e6, step_ms)}`;
}

interface DayTimes {
  /** By the clock of the computer that ran it. */
  readonly robot_ms: number;
  /** Name of the robot if it is remote. */
  readonly robot: string | null;
  /** Null if the offset of the robot's clock is unknown. */
  readonly utc: BoundedTime | null;
}

interface BoundedTime {
  readonly at_ms: number;
  /** Greatest possible error. */
  readonly off_ms: number;
  /** True if `at_ms` is only an upper bound, because without an up-link the lower one is unknown. */
  readonly isLatest: boolean;
}

function dayTimesOf({ journal, now }: Watch, t_ns: number): DayTimes | null {
  const { run, robot } = now.value ?? {};
  if (!run || !journal.hasClockAt(t_ns)) return null;
  const robot_ms = run.started_ms + t_ns / 1e6;
  if (run.robot === undefined) {
    return { robot_ms, robot: null, utc: { at_ms: robot_ms, off_ms: 0, isLatest: false } };
  }
  return { robot_ms, robot: run.robot, utc: robot?.clock ? utcOf(robot_ms, robot.clock) : null };
}

function utcOf(robot_ms: number, { least_ms, most_ms }: ClockOffset): BoundedTime {
  if (most_ms === null) return { at_ms: robot_ms - least_ms, off_ms: 0, isLatest: true };
  const off_ms = (most_ms - least_ms) / 2;
  return { at_ms: robot_ms - least_ms - off_ms, off_ms, isLatest: false };
}

/** `12:01:23 UTC ± 2.1 s`, `12:01:23 UTC or earlier`. */
function bounded({ at_ms, off_ms, isLatest }: BoundedTime, digits: number, scale: TimeScale) {
  const text = clock(at_ms, digits, scale);
  if (isLatest) return `${text} or earlier`;
  // A bound is never rounded down.
  return off_ms === 0 ? text : `${text} ± ${(Math.ceil(off_ms / 100) / 10).toFixed(1)} s`;
}

function robotClock({ robot_ms, robot }: DayTimes, digits: number): string {
  const text = clock(robot_ms, digits, "utc");
  return robot === null ? text : text.replace("UTC", `by ${robot}`);
}

/** A duration at the resolution of `step_ms`: `12.345 s`, `1:02:03.5`. */
export function sinceStart(exact_ms: number, step_ms: number): string {
  const digits = digitsOf(step_ms);
  // Rounded down: no time is shown before it is reached.
  const unit_ms = SECOND / 10 ** digits;
  const ms = Math.floor(exact_ms / unit_ms + 1e-6) * unit_ms;
  if (ms < MINUTE) return `${(ms / SECOND).toFixed(digits)} s`;
  const seconds = ((ms % MINUTE) / SECOND)
    .toFixed(digits)
    .padStart(digits === 0 ? 2 : digits + 3, "0");
  const [hours, minutes] = [Math.floor(ms / HOUR), Math.floor(ms / MINUTE) % 60];
  return hours > 0 ? `${hours}:${two(minutes)}:${seconds}` : `${minutes}:${seconds}`;
}

function digitsOf(step_ms: number): number {
  return step_ms >= SECOND ? 0 : Math.min(6, Math.ceil(-Math.log10(step_ms / SECOND)));
}

function clock(at_ms: number, digits: number, scale: TimeScale = timeScale.value): string {
  return new Date(at_ms).toLocaleTimeString("en-GB", {
    timeZone: zoneOf(scale),
    hour: "2-digit",
    minute: "2-digit",
    second: "2-digit",
    hourCycle: "h23",
    timeZoneName: "short",
    ...(digits > 0 ? { fractionalSecondDigits: Math.min(digits, 3) as 1 | 2 | 3 } : {}),
  });
}

/** Undefined for local time, which the mission scale uses here, too. */
function zoneOf(scale: TimeScale): string | undefined {
  return scale === "utc" || scale === "robot" ? "UTC" : undefined;
}

/** `22 Nov`, or `22 Nov 2026`. */
function dateOf(at_ms: number, isThisYear: boolean): string {
  return new Date(at_ms).toLocaleDateString("en-GB", {
    timeZone: zoneOf(timeScale.value),
    day: "numeric",
    month: "short",
    ...(isThisYear ? {} : { year: "numeric" }),
  });
}

function two(number: number): string {
  return String(number).padStart(2, "0");
}
