import { computed, type Signal, signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { RunNow } from "../../model/generated/protocol.ts";
import { Journal } from "../history/journal.ts";
import type { Link } from "../page/server.ts";
import { events } from "../testing/events.ts";
import { gapsOf, lackingOf } from "./gaps.ts";

const UP: Link = { state: "connecting" };

function truth(elapsed_ms: number, link: RunNow["link"] = "up", heard_ms = 0): RunNow {
  const [run, snapshot] = [{ phase: "live" }, { elapsed_ms }];
  const [snapshot_ms, runner_heard_ms] = [5_000, 5_000 + heard_ms];
  return { run, link, snapshot, snapshot_ms, runner_heard_ms } as unknown as RunNow;
}

/** A run whose server confirms it until its program was received last. */
function confirmed(now: Signal<RunNow | null>) {
  const proven_ms = computed(() => now.value?.runner_heard_ms ?? null);
  return { now, proven_ms, isCurrent: signal(true) };
}

function page(link: Signal<Link>) {
  return { server: { link, pulse: signal(null) } };
}

function watched(whenClosed: (stop: () => void) => void = () => {}) {
  const up = { ...UP, state: "up" } as unknown as Link;
  const link = signal<Link>(up);
  const now = signal<RunNow | null>(truth(100));
  const gaps = gapsOf({ ...confirmed(now), journal: new Journal(), whenClosed }, page(link));
  return { link, now, gaps, up };
}

test("a gap lasts from what was heard last to what is heard first again", () => {
  const { link, now, gaps, up } = watched();
  expect(gaps.value).toEqual([]);
  link.value = { state: "down", since_ms: 0, retry_ms: null, reason: "gone" };
  expect(gaps.value).toEqual([{ from_ns: 100e6, to_ns: null }]);
  link.value = up;
  expect(gaps.value.at(-1)?.to_ns).toBeNull();
  now.value = truth(900);
  expect(gaps.value).toEqual([{ from_ns: 100e6, to_ns: 900e6 }]);
});

test("of many gaps the oldest become one, so that no silence looks received", () => {
  const { now, gaps } = watched();
  for (let gap = 1; gap <= 250; gap += 1) {
    now.value = truth(gap * 1_000, "silent");
    now.value = truth(gap * 1_000 + 500);
  }
  expect(gaps.value).toHaveLength(200);
  expect(gaps.value[0]).toEqual({ from_ns: 1_000e6, to_ns: 51_500e6 });
  expect(gaps.value.at(-1)).toEqual({ from_ns: 250_000e6, to_ns: 250_500e6 });
});

test("a server that lost the run is a gap as well, a run that is over has none", () => {
  const { link, now, gaps } = watched();
  now.value = truth(200, "down");
  now.value = truth(200, "down");
  now.value = truth(450);
  expect(gaps.value).toEqual([{ from_ns: 200e6, to_ns: 450e6 }]);
  now.value = { ...truth(500), run: { phase: "finished" } } as unknown as RunNow;
  link.value = { state: "down", since_ms: 0, retry_ms: null, reason: "gone" };
  expect(gaps.value.length).toBe(1);
});

test("a silence of the run's program is a gap from when it was heard last, though it had nothing to say before", () => {
  const { now, gaps } = watched();
  now.value = truth(200, "silent", 1_000);
  expect(gaps.value).toEqual([{ from_ns: 1_200e6, to_ns: null }]);
  now.value = truth(200, "up", 9_000);
  expect(gaps.value).toEqual([{ from_ns: 1_200e6, to_ns: 9_200e6 }]);
});

test("what the journal was told counts, if it is later", () => {
  const journal = new Journal();
  const entries = events("> R\n> R/A");
  journal.add(entries, 3);
  const now = signal<RunNow | null>(truth(0, "down"));
  const link = signal({ state: "up" } as unknown as Link);
  const gaps = gapsOf({ ...confirmed(now), journal, whenClosed: () => {} }, page(link));
  expect(gaps.value).toEqual([{ from_ns: 2e6, to_ns: null }]);
});

test("a run that the page has left follows the connection no more", () => {
  const stops: (() => void)[] = [];
  const { link, gaps } = watched((stop) => stops.push(stop));
  for (const stop of stops) stop();
  link.value = { state: "down", since_ms: 0, retry_ms: null, reason: "gone" };
  expect(gaps.value).toEqual([]);
  expect(stops.length).toBe(1);
});

test("what a station does not have yet is a gap from the end of its history to the state that came ahead", () => {
  const journal = new Journal();
  journal.add(events("> R\n> R/A"), 3);
  const at = (elapsed_ms: number, missing: number) =>
    lackingOf({
      now: signal({ ...truth(elapsed_ms), robot: { missing } } as unknown as RunNow),
      journal,
    });
  expect(at(800, 7)).toEqual([{ from_ns: 2e6, to_ns: 800e6 }]);
  expect(at(800, 0)).toEqual([]);
  expect(at(1, 7)).toEqual([]);
  expect(lackingOf({ now: signal(truth(800)), journal })).toEqual([]);
});
