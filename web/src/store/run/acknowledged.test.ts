import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Event, JsonValue } from "../../model/generated/protocol.ts";
import { FAILURES_MAX } from "../history/failures.ts";
import { Journal } from "../history/journal.ts";
import { memoryStore } from "../local_store.ts";
import { twoTabs } from "../testing/two_tabs.ts";
import { acknowledge, droppedFailures, failures, openFailures } from "./acknowledged.ts";

/** A run with a growing journal. */
function run(id: string) {
  const journal = new Journal();
  const journalVersion = signal(0);
  const tell = (...events: readonly Event[]) => {
    const from = journal.next;
    const entries = events.map((event, at) => ({ sequence: from + at, t_ns: from + at, event }));
    journal.add(entries, from + events.length);
    journalVersion.value = journal.length;
  };
  return { watch: { id, journal, journalVersion }, tell };
}

function left(path: string, id = -1, error: JsonValue = null): Event {
  return { type: "left", path, outcome: { id, name: id < 0 ? "aborted" : "success" }, error };
}

const NO_BOX = { __exc__: "ValueError", msg: "no box" };
const NO_BOX_LOGGED = "Traceback (most recent call last):\nValueError: no box\n";

function log(level: "info" | "warning" | "error", message: string): Event {
  return { type: "log", path: "R/A", level, stream: "logger", message };
}

function words(watch: ReturnType<typeof run>["watch"]): readonly string[] {
  return openFailures(watch).value.map(
    ({ sequence, kind, path, reach, count, text }) =>
      `${sequence} ${kind} ${path}${reach === path ? "" : ` up to ${reach}`}${count > 1 ? ` ×${count}` : ""} ${text}`,
  );
}

test("an error that climbs is one failure, and one elsewhere is another", () => {
  const { watch, tell } = run("climbs");
  tell(left("R/A/B"), left("R/A"));
  expect(words(watch)).toEqual(["1 aborted R/A/B up to R/A "]);
  tell(left("R"), left("R/C/D", 0), left("R/C"));
  expect(words(watch)).toEqual(["1 aborted R/A/B up to R ", "5 aborted R/C "]);
});

test("text on the standard error and records below warning need no acknowledgement", () => {
  const { watch, tell } = run("chatty");
  const base = { type: "log", path: "R/A" } as const;
  tell(
    { ...base, level: "debug", stream: "logger", message: "robot.driver: connect" },
    { ...base, level: "info", stream: "stderr", message: "INFO robot.driver connected" },
    { ...base, level: "info", stream: "stderr", message: "100%|████| 3/3" },
  );
  expect(words(watch)).toEqual([]);
});

test("the same of the same state counts, whatever comes between, and stays at its place", () => {
  const { watch, tell } = run("loop");
  for (const distance of ["0.31", "0.28", "0.5"]) {
    tell(log("warning", `an obstacle is ${distance} m away`));
    tell(log("error", "Traceback (most recent call last):\nValueError: no box\n"), left("R/A"));
    tell({ type: "entered", path: "R/B" }, left("R/B", 0));
  }
  expect(words(watch)).toEqual([
    "11 log R/A ×3 an obstacle is 0.5 m away",
    "13 aborted R/A ×3 ValueError: no box",
  ]);
  const before = openFailures(watch).value.map(({ first }) => first);
  acknowledge(watch, [13], memoryStore());
  tell(left("R/A", -1, NO_BOX));
  expect(words(watch).at(-1)).toBe("16 aborted R/A ×4 ValueError: no box");
  expect(openFailures(watch).value.map(({ first }) => first)).toEqual(before);
});

test("an error that was handled does not climb", () => {
  const { watch, tell } = run("handled");
  tell(left("R/A"), { type: "entered", path: "R/B" }, left("R/B", 0), left("R"));
  expect(words(watch)).toEqual(["1 aborted R/A ", "4 aborted R "]);
});

test("a failed script is one failure with the last line of its traceback", () => {
  const { watch, tell } = run("traceback");
  tell(log("error", "Traceback (most recent call last):\nValueError: no box\n"), left("R/A"));
  expect(words(watch)).toEqual(["2 aborted R/A ValueError: no box"]);
});

test("an error is told by its own words, and its traceback is no other failure", () => {
  const { watch, tell } = run("own");
  tell(log("error", NO_BOX_LOGGED), left("R/A", -1, NO_BOX), left("R", -1, NO_BOX));
  expect(words(watch)).toEqual(["2 aborted R/A up to R ValueError: no box"]);
});

test("what the script said itself before its error stays", () => {
  const { watch, tell } = run("reported");
  tell(log("error", "the arm is blocked"), left("R/A", -1, NO_BOX));
  expect(words(watch)).toEqual([
    "1 log R/A the arm is blocked",
    "2 aborted R/A ValueError: no box",
  ]);
});

test("an error fails a state whatever its outcome, and climbs so", () => {
  const { watch, tell } = run("other outcome");
  tell(left("R/A", 0, "slipped"), { type: "entered", path: "R/B" }, left("R/B", -1, NO_BOX));
  tell(left("R", 0, NO_BOX));
  expect(words(watch)).toEqual(["1 error R/A slipped", "3 aborted R/B up to R ValueError: no box"]);
});

test("an error that is kept no more is told by its traceback", () => {
  const { watch, tell } = run("gone");
  const gone = { __repr__: "<no longer kept>", __class__: "" };
  tell(log("error", NO_BOX_LOGGED), left("R/A", -1, gone), left("R/C", 0, gone));
  expect(words(watch)).toEqual(["2 aborted R/A ValueError: no box", "3 error R/C "]);
});

test("an error of a script's own class is told without the name of its module", () => {
  const { watch, tell } = run("module");
  tell(log("error", "Traceback (most recent call last):\nscript160.NoPath: none"), left("R/A"));
  expect(words(watch)).toEqual(["2 aborted R/A NoPath: none"]);
});

test("the same warning in a row is told once, and wants another look each time", () => {
  const { watch, tell } = run("warns");
  tell(log("info", "fine"), log("warning", "slips"), log("warning", "slips"));
  expect(words(watch)).toEqual(["3 log R/A ×2 slips"]);
  acknowledge(watch, [3]);
  expect(words(watch)).toEqual([]);
  tell(log("warning", "slips"));
  expect(words(watch)).toEqual(["4 log R/A ×3 slips"]);
});

test("deadlines, scripts that were cut off and crashes are told in words", () => {
  const { watch, tell } = run("others");
  tell(
    { type: "deadline_passed", path: "R/A", deadline_ms: 1500 },
    { type: "cut_off", path: "R/A", grace_ms: 5000 },
    { type: "resumed", life: 2, crash: { reason: "signal 9", active: [] }, policy: "abort" },
  );
  expect(words(watch)).toEqual([
    "1 deadline R/A has run longer than its deadline of 1.5 s",
    "2 cut-off R/A ignored its preemption and was cut off after 5 s",
    "3 crash  The program of the run died (signal 9). The run was resumed; this is life 2.",
  ]);
});

test("nothing new is the same list, so that no one is drawn again", () => {
  const { watch, tell } = run("same");
  tell(left("R/A"));
  const before = failures(watch).value;
  tell({ type: "entered", path: "R/B" });
  expect(failures(watch).value).toBe(before);
});

test("at the bound of failures acknowledged ones leave first, then the oldest open ones", () => {
  const { watch, tell } = run("many failures");
  const paths = Array.from({ length: FAILURES_MAX }, (_, at) => `R/${at}/A`);
  tell(...paths.map((path) => left(path)));
  const has = (...sequences: readonly number[]) => {
    const listed = new Set(failures(watch).value.map(({ sequence }) => sequence));
    return sequences.map((sequence) => listed.has(sequence));
  };
  expect([failures(watch).value.length, droppedFailures(watch).value.all]).toEqual([1_000, 0]);
  acknowledge(watch, [500, 700]);
  tell(left("R/B/A"));
  expect(has(1, 500, 700, 1_001)).toEqual([true, false, true, true]);
  tell(left("R/C/A"));
  expect(has(1, 700, 1_002)).toEqual([true, false, true]);
  expect(droppedFailures(watch).value).toEqual({ open: 0, all: 2 });
  tell(left("R/D/A"), left("R/E/A"));
  expect(has(1, 2, 3, 1_004)).toEqual([false, false, true, true]);
  expect(droppedFailures(watch).value).toEqual({ open: 2, all: 4 });
  expect(openFailures(watch).value.length).toBe(FAILURES_MAX);
  tell(left("R/E/A"));
  expect(openFailures(watch).value.at(-1)?.count).toBe(2);
});

test("of a run that is read again acknowledged failures leave first too", () => {
  const { watch, tell } = run("read again");
  acknowledge(watch, [1_001], memoryStore());
  tell(...Array.from({ length: 1_002 }, (_, at) => left(`R/${at}/A`)));
  expect(
    openFailures(watch)
      .value.map(({ sequence }) => sequence)
      .slice(0, 2),
  ).toEqual([2, 3]);
  expect(droppedFailures(watch).value).toEqual({ open: 1, all: 2 });
});

test("what was acknowledged is kept by run, and old runs make room", () => {
  const localStore = memoryStore();
  for (let at = 0; at < 60; at += 1) acknowledge(run(`kept ${at}`).watch, [at], localStore);
  const all = localStore.get("rafcon.acknowledged") as Record<string, readonly number[]>;
  expect(Object.keys(all)).toHaveLength(50);
  expect(all["kept 59"]).toEqual([59]);
});

test("the browser is listened to once, however many runs are looked at", () => {
  const [here, there] = twoTabs();
  let listeners = 0;
  const localStore = {
    ...here,
    whenOther: (key: string, listener: () => void) => {
      listeners += 1;
      here.whenOther(key, listener);
    },
  };
  const runs = [run("many 1"), run("many 2"), run("many 3")];
  for (const { watch, tell } of runs) {
    tell(left("R/A"));
    acknowledge(watch, [], localStore);
  }
  expect(listeners).toBe(1);
  there.put("rafcon.acknowledged", { "many 2": [1] });
  expect(runs.map(({ watch }) => words(watch).length)).toEqual([1, 0, 1]);
});

test("of a run at most 2,000 acknowledgements are kept, the last ones", () => {
  const localStore = memoryStore();
  const { watch, tell } = run("all seen");
  const kept = () => localStore.get("rafcon.acknowledged") as Record<string, readonly number[]>;
  tell(left("R/A"));
  const all = Array.from({ length: 2_000 }, (_, at) => at + 1);
  acknowledge(watch, all, localStore);
  expect([kept()["all seen"]?.length, words(watch).length]).toEqual([2_000, 0]);
  acknowledge(watch, [2_001], localStore);
  expect([kept()["all seen"]?.length, kept()["all seen"]?.at(-1)]).toEqual([2_000, 2_001]);
  expect(words(watch)).toEqual(["1 aborted R/A "]);
  acknowledge(watch, [1], localStore);
  expect(words(watch)).toEqual([]);
});

test("a long error is told by its first 400 characters", () => {
  const { watch, tell } = run("long");
  tell(left("R/A", -1, { __exc__: "ValueError", msg: "x".repeat(1_000) }));
  const text = openFailures(watch).value[0]?.text ?? "";
  expect([text.length, text.endsWith("…")]).toEqual([400, true]);
});
