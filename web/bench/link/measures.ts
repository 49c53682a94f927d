/** The figures of the gate from what operators and robot noted. All times are ms of this computer's clock, on which robot, station
 * and operators run: so latencies are true. */

import type { Event } from "../../src/model/generated/protocol.ts";
import type { Given, Notes } from "./operator.ts";

export interface Span {
  readonly from: number;
  readonly to: number;
}

/** An event as `rafcon history --json` prints it. */
export interface Kept {
  readonly sequence: number;
  readonly t_ns: number;
  readonly event: Event;
}

/** What is known of an hour over the link. */
export interface Hour {
  readonly delay_ms: number;
  readonly bits_per_s: number;
  /** When the link was whole, without the time in which it settles after a cut. */
  readonly whole: readonly Span[];
  /** The same without an up-link. */
  readonly oneWay: readonly Span[];
  /** Cuts of both directions; the second is the long one. */
  readonly cuts: readonly Span[];
  /** When nothing happened, and what the robot sent then. */
  readonly quiet: Span & { readonly bytes: number };
  /** What the robot sent while the link was whole. */
  readonly wholeBytes: number;
  readonly page_live_ms: number;
  /** Without an up-link: when a station without a replica began, and when it was live first; null if there was none. */
  readonly late: Span | null;
  readonly robotJournal: readonly Kept[];
  readonly replicas: readonly (readonly Kept[])[];
  /** Who looked on beside the robot. */
  readonly observer: Notes;
  /** Who looked on at stations; the first was awake all the time. */
  readonly operators: readonly Notes[];
  readonly memory: Readonly<Record<string, readonly number[]>>;
  /** What of the scenario could not be done. */
  readonly failures: number;
}

/** A line of the table; without a bar it is only told. */
export interface Figure {
  readonly name: string;
  readonly value: number;
  readonly unit: string;
  readonly bar: number | null;
}

export function figures(hour: Hour): readonly Figure[] {
  const { delay_ms, operators, robotJournal } = hour;
  const first = operators[0];
  if (!first) throw new Error("nobody looked on");
  const happened = times(hour);
  const seen = firstSeen(first, robotJournal.length);
  const inStatus = firstSeen({ ...first, events: [] }, robotJournal.length);
  const late = (spans: readonly Span[], shown = seen) =>
    within(happened, spans).map(
      (sequence) => (shown[sequence] ?? 0) - (happened[sequence] ?? 0) - delay_ms,
    );
  const whole = late(hour.whole);
  const figure = (name: string, value: number, unit: string, bar: number | null) => ({
    name,
    value,
    unit,
    bar,
  });
  const seconds = (name: string, ms: number, bar: number | null) =>
    figure(name, ms / 1_000, "s", bar);
  const wholeEvents = within(happened, hour.whole).length;
  const quiet_s = (hour.quiet.to - hour.quiet.from) / 1_000;
  const [live, fill] = [liveAfter(hour, happened, seen), backfill(hour, happened, first)];
  const hold = holds(hour, happened);
  return [
    ...differences(robotJournal, hour.replicas),
    figure("link_bytes_per_event", hour.wholeBytes / Math.max(1, wholeEvents), "B", 50),
    seconds("live_after_return_s", most(live), 0.5),
    seconds("latency_p50_s", quantile(whole, 0.5), 0.05),
    seconds("latency_p99_s", quantile(whole, 0.99), 0.3),
    seconds("hold_effective_s", most(hold), 0.2),
    seconds("one_way_latency_p99_s", quantile(late(hour.oneWay), 0.99), 0.5),
    ...(hour.late
      ? [seconds("one_way_late_joiner_s", hour.late.to - hour.late.from - delay_ms, 10)]
      : []),
    seconds("backfill_12min_s", fill.took_ms, fill.bar_ms / 1_000),
    figure("commands_late_or_twice", lateOrTwice(robotJournal, happened, operators), "", 0),
    figure("idle_down_bits_per_s", (hour.quiet.bytes * 8) / quiet_s, "bit/s", 5_000),
    seconds("page_live_at_station_s", hour.page_live_ms, 2),
    figure(
      "told_twice",
      operators.reduce((sum, { twice }) => sum + twice, 0),
      "",
      0,
    ),
    figure(
      "told_missing",
      operators.reduce((sum, one) => sum + missing(one, robotJournal), 0),
      "",
      0,
    ),
    ...Object.entries(hour.memory).map(([name, mb]) =>
      figure(`${name}_memory_growth`, growth(mb), "MB", null),
    ),
    seconds("status_latency_p50_s", quantile(late(hour.whole, inStatus), 0.5), null),
    seconds("status_latency_p99_s", quantile(late(hour.whole, inStatus), 0.99), null),
    figure("steps_failed", hour.failures, "", 0),
    figure("events", robotJournal.length, "", null),
    figure(
      "commands",
      operators.reduce((sum, { given }) => sum + given.length, 0),
      "",
      null,
    ),
    figure("holds", hold.length, "", null),
  ];
}

/** When each event happened, and when an operator was shown it: by its sequence, in ms. */
export interface Followed {
  readonly happened: readonly number[];
  readonly seen: readonly number[];
}

/** What an operator was shown of a run. */
export function shown(robot: Pick<Hour, "robotJournal" | "observer">, notes: Notes): Followed {
  return { happened: times(robot), seen: firstSeen(notes, robot.robotJournal.length) };
}

/** When each event happened, by its sequence. The observer beside the robot was told of some at once: that gives the begin. */
function times({
  robotJournal,
  observer,
}: Pick<Hour, "robotJournal" | "observer">): readonly number[] {
  const observedAt = new Map(observer.events);
  const begin = robotJournal.reduce((least, { sequence, t_ns }) => {
    const at = observedAt.get(sequence);
    return at === undefined ? least : Math.min(least, at - t_ns / 1e6);
  }, Number.POSITIVE_INFINITY);
  const happened: number[] = [];
  for (const { sequence, t_ns } of robotJournal) happened[sequence] = begin + t_ns / 1e6;
  return happened;
}

/** When each event was in what the operator was shown: told itself, or in a later state. */
function firstSeen(
  { events, statuses }: Pick<Notes, "events" | "statuses">,
  last: number,
): readonly number[] {
  const seen = new Array<number>(last + 1).fill(Number.POSITIVE_INFINITY);
  for (const [sequence, at] of [
    ...events,
    ...statuses.map(([sequence, at]) => [sequence, at] as const),
  ]) {
    if (sequence <= last) seen[sequence] = Math.min(seen[sequence] ?? at, at);
  }
  for (let sequence = last - 1; sequence >= 0; sequence -= 1) {
    seen[sequence] = Math.min(seen[sequence] ?? 0, seen[sequence + 1] ?? 0);
  }
  return seen;
}

export function within(happened: readonly number[], spans: readonly Span[]): readonly number[] {
  const found: number[] = [];
  happened.forEach((at, sequence) => {
    if (spans.some(({ from, to }) => at >= from && at < to)) found.push(sequence);
  });
  return found;
}

/** From the end of each cut to a state that has everything that had happened by then, above the delay. */
function liveAfter(
  hour: Hour,
  happened: readonly number[],
  seen: readonly number[],
): readonly number[] {
  return hour.cuts.map(({ to }) => (seen[headAt(happened, to)] ?? 0) - to - hour.delay_ms);
}

/** The last event that had happened by then. */
export function headAt(happened: readonly number[], time: number): number {
  return happened.reduce((last, at, sequence) => (at <= time ? sequence : last), 0);
}

/** An event of a mission takes about so many bytes on the link. */
const EVENT_BYTES = 20;

/** From the end of the long cut to the first moment at which the operator was told everything before it; and in which time that was
 * to be: two delays, a second, and 1.15 times what the missing events take at the rate. */
function backfill(hour: Hour, happened: readonly number[], { events }: Notes) {
  const cut = hour.cuts[1];
  if (!cut) return { took_ms: 0, bar_ms: 0 };
  const [head, before] = [headAt(happened, cut.to), headAt(happened, cut.from)];
  const at = events.find(([sequence]) => sequence >= head)?.[1] ?? Number.POSITIVE_INFINITY;
  const takes_ms = ((head - before) * EVENT_BYTES * 8_000) / hour.bits_per_s;
  return { took_ms: at - cut.to, bar_ms: takes_ms * 1.15 + hour.delay_ms * 2 + 1_000 };
}

/** From each hold to its effect, above the delay, while the link was whole. */
function holds(hour: Hour, happened: readonly number[]): readonly number[] {
  const given = commandsBy(hour.operators);
  const found: number[] = [];
  for (const { sequence, event } of hour.robotJournal) {
    if (event.type !== "commanded" || event.answer.answer !== "applied") continue;
    if (event.envelope.command.type !== "pause") continue;
    const sent = given.get(own(event.envelope.id))?.sent_ms;
    if (sent === undefined || !hour.whole.some(({ from, to }) => sent >= from && sent < to))
      continue;
    found.push((happened[sequence] ?? 0) - sent - hour.delay_ms);
  }
  return found;
}

function commandsBy(operators: readonly Notes[]): ReadonlyMap<string, Given> {
  return new Map(operators.flatMap(({ given }) => given.map((one) => [one.id, one] as const)));
}

/** A server puts the user's name before a command's id. */
function own(id: string): string {
  return id.slice(id.indexOf("/") + 1);
}

/** Clocks of one computer, read by two programs. */
const CLOCK_MS = 20;

function lateOrTwice(
  journal: readonly Kept[],
  happened: readonly number[],
  operators: readonly Notes[],
): number {
  const [given, done] = [commandsBy(operators), new Set<string>()];
  let wrong = 0;
  for (const { sequence, event } of journal) {
    if (event.type !== "commanded" || event.answer.answer !== "applied") continue;
    const { id } = event.envelope;
    const expiry = given.get(own(id))?.expiry_ms ?? null;
    const isLate = expiry !== null && (happened[sequence] ?? 0) > expiry + CLOCK_MS;
    if (done.has(id) || isLate) wrong += 1;
    done.add(id);
  }
  return wrong;
}

/** Of all replicas together. */
function differences(
  robot: readonly Kept[],
  replicas: readonly (readonly Kept[])[],
): readonly Figure[] {
  const bySequence = (all: readonly Kept[]) =>
    new Map(all.map((kept) => [kept.sequence, JSON.stringify(kept)]));
  const here = bySequence(robot);
  let [missing, extra, different] = [0, 0, 0];
  for (const replica of replicas) {
    const there = bySequence(replica);
    for (const [sequence, text] of here) {
      if (!there.has(sequence)) missing += 1;
      else if (there.get(sequence) !== text) different += 1;
    }
    extra += [...there.keys()].filter((sequence) => !here.has(sequence)).length;
  }
  const count = (name: string, value: number) => ({ name, value, unit: "", bar: 0 });
  return [
    count("replica_missing", missing),
    count("replica_extra", extra),
    count("replica_different", different),
  ];
}

/** Events of the journal that an operator was never told. */
function missing({ events }: Notes, journal: readonly Kept[]): number {
  const received = new Set(events.map(([sequence]) => sequence));
  return journal.filter(({ sequence }) => !received.has(sequence)).length;
}

/** From a third of the time on, to the end. */
function growth(mb: readonly number[]): number {
  const warm = mb.slice(Math.floor(mb.length / 3));
  return (warm.at(-1) ?? 0) - (warm[0] ?? 0);
}

/** The highest; none of none. */
function most(values: readonly number[]): number {
  return values.length === 0 ? Number.NaN : Math.max(...values);
}

export function quantile(values: readonly number[], part: number): number {
  const sorted = values.toSorted((one, other) => one - other);
  return sorted[Math.min(sorted.length - 1, Math.ceil(part * (sorted.length - 1)))] ?? 0;
}

export function printed(found: readonly Figure[], json: boolean): boolean {
  for (const { name, value, unit, bar } of found) {
    const rounded = Math.round(value * 1_000) / 1_000;
    const verdict = bar === null ? "" : `at most ${bar}${isKept(value, bar) ? "" : "  MISSED"}`;
    const row = `${name.padEnd(28)}${String(rounded).padStart(12)} ${unit.padEnd(6)}${verdict}`;
    process.stdout.write(`${json ? JSON.stringify({ name, value: rounded, unit, bar }) : row}\n`);
  }
  return found.every(({ value, bar }) => isKept(value, bar));
}

/** What was not measured is not kept. */
function isKept(value: number, bar: number | null): boolean {
  return bar === null || value <= bar;
}
