import { afterEach, expect, test } from "vitest";
import type { ClockOffset, HistoryEntry, RunNow } from "../../model/generated/protocol.ts";
import { Journal } from "../history/journal.ts";
import type { Watch } from "../history/run.ts";
import {
  clockTimes,
  missionClock,
  missionTime,
  runTime,
  runTimes,
  startedAt,
  TIME_SCALES,
  timeScale,
  wallTime,
} from "./times.ts";

const NOON_MS = Date.UTC(2026, 10, 22, 12, 0, 0);

/** A run that started at noon UTC, with these events. */
function watch(events: readonly HistoryEntry[] = [], robot: Partial<RunNow> = {}): Watch {
  const journal = new Journal();
  journal.add(events, events.length + 1);
  const run = { started_ms: NOON_MS };
  return { journal, now: { value: { run, ...robot } } } as unknown as Watch;
}

/** A run of a remote robot that started at noon by its own clock, with this knowledge of that clock. */
function farAway(clock: ClockOffset | null): Watch {
  const run = { started_ms: NOON_MS, robot: "scout" };
  return watch([], { run, robot: { clock } } as unknown as Partial<RunNow>);
}

/** A time of the run on each scale, and on all scales together. */
function onAllScales(run: Watch): Readonly<Record<string, string>> {
  const times = TIME_SCALES.filter(({ value }) => value !== "local").map(({ value }) => {
    timeScale.value = value;
    return [value, runTime(run, 83_250e6)];
  });
  const isLocal = (line: string) => line.includes(":") && !/UTC|T\+|scout/.test(line);
  const all = runTimes(run, 83_250e6).split("\n");
  const { utc, robot } = clockTimes(run, 83_250e6) ?? {};
  return {
    ...Object.fromEntries(times),
    all: all.filter((line) => !isLocal(line)).join(", "),
    clocks: `${utc} / ${robot}`,
  };
}

afterEach(() => {
  timeScale.value = "mission";
});

test("times since the start have as many digits as their step needs", () => {
  const times: readonly [number, number][] = [
    [12_345, 1_000],
    [12_345, 100],
    [12_345, 1],
    [72_500, 100],
    [72_500, 5_000],
    [3_723_400, 100],
    [59_999.6, 1],
    [119_999.9, 100],
  ];
  expect(times.map(([ms, step_ms]) => missionTime(ms * 1e6, step_ms))).toEqual([
    "T+12 s",
    "T+12.3 s",
    "T+12.345 s",
    "T+1:12.5",
    "T+1:12",
    "T+1:02:03.4",
    "T+59.999 s",
    "T+1:59.9",
  ]);
});

test("a time of a run is on the scale of the settings", () => {
  const run = watch();
  expect(runTime(run, 83_250e6)).toBe("T+1:23.250");
  timeScale.value = "utc";
  expect(runTime(run, 83_250e6)).toBe("12:01:23.250 UTC");
  expect(runTime(run, 83_250e6, 1_000)).toBe("12:01:23 UTC");
  timeScale.value = "local";
  const hour = String(new Date(NOON_MS).getHours()).padStart(2, "0");
  expect(runTime(run, 83_250e6)).toMatch(new RegExp(`^${hour}:\\d\\d:23\\.250 \\S+$`));
});

test("there is room for all scales", () => {
  const times = runTimes(watch(), 83_250e6).split("\n");
  expect(times.slice(0, 2)).toEqual(["T+1:23.250", "12:01:23.250 UTC"]);
});

test("a run of a robot far away is told by its clock, and in UTC within a bound", () => {
  expect(onAllScales(farAway({ least_ms: 1_000, most_ms: 5_100 }))).toEqual({
    mission: "T+1:23.250",
    utc: "12:01:20.200 UTC",
    robot: "12:01:23.250 by scout",
    all: "T+1:23.250, 12:01:20.200 UTC ± 2.1 s, 12:01:23.250 by scout",
    clocks: "12:01:20 ± 2.1 s / 12:01:23",
  });
});

test("without an up-link UTC has no lower bound, and of a robot that was never heard it is unknown", () => {
  expect(onAllScales(farAway({ least_ms: 1_000, most_ms: null }))).toEqual({
    mission: "T+1:23.250",
    utc: "≤ 12:01:22.250 UTC",
    robot: "12:01:23.250 by scout",
    all: "T+1:23.250, 12:01:22.250 UTC or earlier, 12:01:23.250 by scout",
    clocks: "12:01:22 or earlier / 12:01:23",
  });
  expect(onAllScales(farAway(null))).toEqual({
    mission: "T+1:23.250",
    utc: "12:01:23.250 by scout",
    robot: "12:01:23.250 by scout",
    all: "T+1:23.250, 12:01:23.250 by scout",
    clocks: "unknown / 12:01:23",
  });
});

test("a run of this computer has no other clock than its server", () => {
  expect(onAllScales(watch())).toMatchObject({ robot: "12:01:23.250 UTC", clocks: "12:01:23 / " });
});

test("when a robot's run began is told by the robot's clock", () => {
  timeScale.value = "utc";
  const began = { started_ms: Date.now() };
  expect(startedAt(began)).toMatch(/^\d\d:\d\d:\d\d UTC$/);
  expect(startedAt({ ...began, robot: "scout" })).toMatch(/ UTC by scout’s clock$/);
});

test("a clock face has hours from the start, and as many as it takes", () => {
  expect([83, 754_999, 360_000_000].map(missionClock)).toEqual([
    "T+00:00:00",
    "T+00:12:34",
    "T+100:00:00",
  ]);
});

test("after a crash only mission time is known", () => {
  const resumed = { type: "resumed", life: 2, crash: { reason: "signal 9" }, policy: "wait" };
  const run = watch([{ sequence: 1, t_ns: 5e9, event: resumed } as unknown as HistoryEntry]);
  timeScale.value = "utc";
  expect(runTime(run, 4e9)).toBe("12:00:04.000 UTC");
  expect(runTime(run, 6e9)).toBe("T+6.000 s");
});

test("a time of the day has the date of another day", () => {
  timeScale.value = "utc";
  const day_ms = 24 * 3_600_000;
  expect(wallTime(NOON_MS, NOON_MS + 3_600_000)).toBe("12:00:00 UTC");
  expect(wallTime(NOON_MS, NOON_MS + day_ms)).toBe("22 Nov 12:00:00 UTC");
  expect(wallTime(NOON_MS, NOON_MS + 400 * day_ms)).toBe("22 Nov 2026 12:00:00 UTC");
});
