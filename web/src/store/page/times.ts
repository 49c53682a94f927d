/** Points in time for people, on the scale that the settings name; each says which scale it is on. */

import { signal } from "@preact/signals-core";
import type { Watch } from "../history/run.ts";

/** Since the start of a run, by the clock of the world, or by the clock and zone of this browser. */
export type TimeScale = "mission" | "utc" | "local";

export const TIME_SCALES: readonly { readonly value: TimeScale; readonly title: string }[] = [
  { value: "mission", title: "Since the start of the run (T+)" },
  { value: "utc", title: "UTC" },
  { value: "local", title: "Time zone of this computer" },
];

/** The scale of this browser's settings. */
export const timeScale = signal<TimeScale>("mission");

const SECOND = 1_000;
const MINUTE = 60 * SECOND;
const HOUR = 60 * MINUTE;
const DAY = 24 * HOUR;

/** `14:03:27 UTC` or `15:03:27 CET`, with the date if it is not today's. What belongs to no run has no mission time: then local. */
export function wallTime(at_ms: number, now_ms: number): string {
  const isThisYear = now_ms - at_ms < 300 * DAY;
  const date = dateOf(at_ms, isThisYear);
  return date === dateOf(now_ms, true) ? clock(at_ms, 0) : `${date} ${clock(at_ms, 0)}`;
}

/** A time of a run, to the step that is told apart: `T+12.345 s`, `T+1:02:03.5`, `14:03:27.345 UTC`. A crash stops the clock of
 * a run: after one only mission time is known. */
export function runTime(watch: Watch, t_ns: number, step_ms = 1): string {
  const at_ms = dayTimeOf(watch, t_ns);
  if (timeScale.value === "mission" || at_ms === null) {
    return missionTime(t_ns, step_ms);
  }
  return clock(at_ms, digitsOf(step_ms));
}

/** The same on all scales, one a line, where there is room. */
export function runTimes(watch: Watch, t_ns: number): string {
  const at_ms = dayTimeOf(watch, t_ns);
  const times = at_ms === null ? [] : [clock(at_ms, 3, "utc"), clock(at_ms, 3, "local")];
  return [missionTime(t_ns), ...new Set(times)].join("\n");
}

/** A time since the start of the run: `T+12.345 s`. */
export function missionTime(t_ns: number, step_ms = 1): string {
  return `T+${sinceStart(t_ns / 1e6, step_ms)}`;
}

function dayTimeOf({ journal, now }: Watch, t_ns: number): number | null {
  const began_ms = now.value?.run.started_ms ?? null;
  return began_ms === null || !journal.hasClockAt(t_ns) ? null : began_ms + t_ns / 1e6;
}

/** A length as a time since the start, to the step that is told apart: `12.345 s`, `1:02:03.5`. */
export function sinceStart(exact_ms: number, step_ms: number): string {
  const digits = digitsOf(step_ms);
  // What came is never rounded up to what has not.
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
    timeZone: scale === "utc" ? "UTC" : undefined,
    hour: "2-digit",
    minute: "2-digit",
    second: "2-digit",
    hourCycle: "h23",
    timeZoneName: "short",
    ...(digits > 0 ? { fractionalSecondDigits: Math.min(digits, 3) as 1 | 2 | 3 } : {}),
  });
}

/** `22 Nov`, or `22 Nov 2026`. */
function dateOf(at_ms: number, isThisYear: boolean): string {
  return new Date(at_ms).toLocaleDateString("en-GB", {
    timeZone: timeScale.value === "utc" ? "UTC" : undefined,
    day: "numeric",
    month: "short",
    ...(isThisYear ? {} : { year: "numeric" }),
  });
}

function two(number: number): string {
  return String(number).padStart(2, "0");
}
