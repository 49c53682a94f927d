import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { ActiveState, Hold, Moment, Phase, RunNow } from "../../model/generated/protocol.ts";
import type { RunSnapshot, Watch } from "../history/run.ts";
import { type Active, activeStates, heldBefore, isHolding, lanes, placeOfLane } from "./active.ts";

/** A watch with the shown state only. */
function watching(now: readonly ActiveState[], picture?: Partial<Moment>): Watch {
  const shown = { now: signal<RunNow | null>(null), playhead: signal<number | null>(null) };
  const run = { phase: "live" };
  shown.now.value = { run, snapshot: { active: now, questions: [] } } as unknown as RunNow;
  const snapshot = signal<RunSnapshot | null>(null);
  if (picture) {
    const whole = { held: [], waiting: {}, questions: [], active: [], t_ns: 0, ...picture };
    snapshot.value = { picture: whole as unknown as Moment, at_ms: 0 };
  }
  return { ...shown, playheadSnapshot: snapshot } as unknown as Watch;
}

function state(
  path: string,
  phase: Phase = "running",
  branch = "",
  held: Hold[] = [],
): ActiveState {
  return { path, name: path.slice(-1), phase, since_ms: 5, branch, detail: null, held };
}

const before = (next: string): Hold => ({ next, by: { type: "step" } });

const inWords = (active: readonly Active[]) =>
  active.map((lane) => `${lane.branch}: ${lane.phase} ${placeOfLane(lane)}`).join("\n");

test("what comes next is held by something, and a breakpoint holds", () => {
  const by = { type: "breakpoint", id: 3 } as const;
  const active = [state("R"), state("R/A", "held", "", [{ next: "R/B", by }])];
  expect(heldBefore(active, "R/B")).toEqual(by);
  expect(heldBefore(active, "R/A")).toBeNull();
  expect([3, 4].map((id) => isHolding(active, id))).toEqual([true, false]);
});

test("live, the leaves are the lanes, one a branch", () => {
  const watch = watching([
    state("R"),
    state("R/B"),
    state("R/B/X", "running", "R/B/X"),
    state("R/B/Y", "held", "R/B/Y", [before("R/B/Y/A")]),
  ]);
  expect(inWords(lanes(activeStates(watch)))).toBe("R/B/X: running R/B/X\nR/B/Y: held R/B/Y/A");
});

test("branches that are held before their first state stand beside those that run", () => {
  const watch = watching([
    state("R", "running", "", [before("R/Y"), before("R/Z")]),
    state("R/X", "running", "R/X"),
  ]);
  expect(inWords(lanes(activeStates(watch)))).toBe(
    "R/Y: held R/Y\nR/Z: held R/Z\nR/X: running R/X",
  );
});

test("at a moment its picture is what is active, with branches where states part", () => {
  const pictured = (path: string, since_ns: number) => ({ path, names: path, since_ns });
  const watch = watching([state("R")], {
    t_ns: 9_000_000,
    active: [pictured("R", 0), pictured("R/X", 1_000_000), pictured("R/Y", 0)] as never,
    held: [{ path: "R/Y", ...before("R/Y/A") }],
    waiting: { "R/X": "a start state" },
  });
  expect(inWords(lanes(activeStates(watch)))).toBe(": running R");
  watch.playhead.value = 7;
  expect(inWords(lanes(activeStates(watch)))).toBe("R/X: waiting R/X\nR/Y: held R/Y/A");
  expect(activeStates(watch)[1]?.since_ms).toBe(8);
});

test("a script that asks waits for an answer", () => {
  const watch = watching([state("R")]);
  const now = watch.now.peek();
  Object.assign(now?.snapshot ?? {}, { questions: [{ path: "R" }] });
  expect(activeStates(watch)[0]).toMatchObject({ phase: "waiting", detail: "an answer" });
});

test("nothing is active when a run is over, and a crash interrupts what ran", () => {
  const watch = watching([state("R"), state("R/A", "held")]);
  const now = watch.now.peek();
  const over = { ...now, run: { phase: "finished" } } as unknown as RunNow;
  expect(activeStates({ ...watch, now: signal(over) })).toEqual([]);
  const crashed = { ...now, run: { phase: "crashed" } } as unknown as RunNow;
  const phases = activeStates({ ...watch, now: signal(crashed) }).map(({ phase }) => phase);
  expect(phases).toEqual(["interrupted", "held"]);
});
