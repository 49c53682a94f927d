import { expect, test } from "vitest";
import type { DataPort } from "../../model/ends.ts";
import type { Event, HistoryEntry } from "../../model/generated/protocol.ts";
import { portsOf } from "../../model/machine.ts";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { Journal } from "./journal.ts";
import { originOf } from "./origin.ts";
import { failureAt } from "./script_failure.ts";
import { visitsOf } from "./visits.ts";

/** `A+` enters a state, `A-` leaves it, `A!` logs a traceback; `.` is a value event, which the page does not receive. */
function journalOf(text: string): Journal {
  const journal = new Journal();
  const words = text.split(" ");
  journal.add(
    words.flatMap((word, index) => (word === "." ? [] : [entryOf(word, index)])),
    words.length + 1,
  );
  return journal;
}

function entryOf(word: string, index: number): HistoryEntry {
  return { sequence: index + 1, t_ns: index * 1e6, event: eventOf(word.slice(0, -1), word.at(-1)) };
}

function eventOf(path: string, sign: string | undefined): Event {
  if (sign === "+") return { type: "entered", path };
  if (sign === "-") return { type: "left", path, outcome: { id: 0, name: "success" } };
  const message = `Traceback (most recent call last):\n  File "s.py", line 1, in execute\n    x\nE: ${path}`;
  return { type: "log", path, level: "error", stream: "engine", message };
}

test("the last visit up to a moment, while the journal grows", () => {
  const journal = journalOf("R+ R/A+ R/A- R/B+ R/B- R/A+");
  const visits = visitsOf({ window: journal });
  expect(visits.last("entered", "R/A", null)).toBe(6);
  expect(visits.last("entered", "R/A", 5)).toBe(2);
  expect(visits.last("left", "R/A", 2)).toBeNull();
  expect([visits.count("R/A", 5), visits.count("R/A", 6)]).toEqual([1, 2]);
  journal.add([{ sequence: 7, t_ns: 7e6, event: eventOf("R/A", "-") }], 8);
  expect(visitsOf({ window: journal }).last("left", "R/A", null)).toBe(7);
});

test("the traceback of a state is that of the script inside it", () => {
  const journal = journalOf("R+ R/A+ R/A! R/A- R/B+ R/B- R-");
  expect(failureAt(journal, "R/A", 1, 3)?.traceback.message).toBe("E: R/A");
  expect(failureAt(journal, "R", 0, 6)?.path).toBe("R/A");
  expect(failureAt(journal, "R/B", 4, 5)).toBeNull();
});

/** A state `A` with a value that passes through this number of nested states. */
function nested(count: number): string {
  const level = (depth: number): readonly string[] => {
    if (depth > count) return [];
    const around = depth === 1 ? "A" : `S${depth - 1}`;
    const lines = [
      `S${depth} hierarchy input v:int`,
      ...level(depth + 1).map((line) => `  ${line}`),
    ];
    return [...lines, `${around}.v >> S${depth}.v`];
  };
  return [
    "R hierarchy",
    ...["A execution output v:int", ...level(1)].map((line) => `  ${line}`),
  ].join("\n");
}

test("of a value that came through more than 64 states the 64th around is named", () => {
  const giver = (count: number): string | undefined => {
    const machine = machineOf(sketch(nested(count)));
    const paths = Array.from(
      { length: count },
      (_, last) => `R/${Array.from({ length: last + 1 }, (__, at) => `S${at + 1}`).join("/")}`,
    );
    const words = ["R+", "R/A+", "R/A-", ...paths.map((path) => `${path}+`)];
    const visits = visitsOf({ window: journalOf(words.join(" ")) });
    const path = paths.at(-1) ?? "";
    const state = machine.state(path);
    const id = state && portsOf(state, "input")[0]?.id;
    if (id === undefined) throw new Error(`${path} has no input`);
    return originOf(machine, visits, { kind: "input", path, id }, null)?.path;
  };
  expect(giver(64)).toBe("R/A");
  expect(giver(65)).toBe("R/S1");
  expect(giver(66)).toBe("R/S1/S2");
});

const MACHINE = machineOf(
  sketch(`
    R hierarchy input speed:int=3 scoped found:list
      A execution input speed:int output pose:list
      B execution input pose:list input found:list
      R.speed >> A.speed
      A.pose >> R.found
      A.pose >> B.pose
      R.found >> B.found
  `),
);

function port(kind: DataPort["kind"], path: string, name: string): DataPort {
  const state = MACHINE.state(path);
  const found = state && portsOf(state, kind).find((each) => each.name === name);
  if (!found) throw new Error(`${path} has no ${name}`);
  return { kind, path, id: found.id };
}

test("values came from the states that gave them, at their ends", () => {
  const visits = visitsOf({ window: journalOf("R+ R/A+ R/A- . R/B+ R/B-") });
  const origin = (of: DataPort, until: number | null = null) =>
    originOf(MACHINE, visits, of, until);
  const found = port("scoped_variable", "R", "found");
  expect(origin(found)).toEqual({ sequence: 3, path: "R/A", seen: 4 });
  expect(origin(found, 4)).toEqual({ sequence: 3, path: "R/A", seen: 4 });
  expect(origin(found, 3)).toEqual({ sequence: 1, path: "R", seen: 1 });
  expect(origin(port("output", "R/A", "pose"))).toMatchObject({ sequence: 3, path: "R/A" });
  expect(origin(port("input", "R/B", "found"))).toMatchObject({ sequence: 5, path: "R/A" });
  expect(origin(port("input", "R/A", "speed"))).toMatchObject({ sequence: 2, path: "R" });
  expect(origin(port("input", "R/B", "pose"), 3)).toBeNull();
});
