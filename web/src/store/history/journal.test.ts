import { expect, test } from "vitest";
import type { Event, HistoryEntry } from "../../model/generated/protocol.ts";
import { Journal } from "./journal.ts";

/** Events as short text: `1 0 > R` is an entry, `2 5 < R done` an end, `!` after the path a step back, `3 6 = x` a log line. */
function entriesFrom(text: string): readonly HistoryEntry[] {
  return text
    .trim()
    .split("\n")
    .map((line) => {
      const [sequence = "", t_ns = "", what, path = "", name = ""] = line.trim().split(" ");
      return {
        sequence: Number(sequence),
        t_ns: Number(t_ns),
        event: eventOf(what, path, name),
      };
    });
}

function eventOf(what: string | undefined, path: string, name: string): Event {
  const undoes = path.endsWith("!") ? 1 : null;
  const at = path.replace("!", "");
  if (what === ">") return { type: "entered", path: at, undoes };
  if (what === "<") return { type: "left", path: at, undoes, outcome: { id: 0, name } };
  return { type: "log", path: "R", level: "info", stream: "stdout", message: path };
}

function written(journal: Journal): string {
  return Array.from({ length: journal.length }, (_, index) => {
    const found = journal.at(index);
    if (!found) return "gone";
    const at = `${found.sequence} ${found.t_ns}`;
    if (found.kind === "other")
      return `${at} = ${"message" in found.event ? found.event.message : ""}`;
    const back = found.isBack ? "!" : "";
    const end = found.outcome ? ` ${found.outcome.name}` : "";
    return `${at} ${found.kind === "entered" ? ">" : "<"} ${found.path}${back}${end}`;
  }).join("\n");
}

const RUN = `1 0 > R
2 10 > R/A
4 15 = hello
5 30 < R/A ok
6 30 > R/A
7 50 < R/A ok
8 50 > R/A!
9 60 < R/A! back`;

test("what was told is there once, whatever comes twice and however it is cut", () => {
  const journal = new Journal();
  const all = entriesFrom(RUN);
  journal.add(all.slice(0, 4), 6);
  journal.add(all.slice(2), 12);
  journal.add(all, 12);
  expect(written(journal)).toBe(RUN);
  expect(journal.next).toBe(12);
});

test("events are found by number and by time", () => {
  const journal = new Journal();
  journal.add(entriesFrom(RUN), 10);
  expect([journal.indexOf(3), journal.indexOf(5), journal.indexOf(99)]).toEqual([2, 3, 8]);
  expect([journal.indexAt(0), journal.indexAt(11), journal.indexAt(99)]).toEqual([0, 2, 8]);
});

test("entries, ends and times are counted, and steps back are not", () => {
  const journal = new Journal();
  journal.add(entriesFrom(RUN), 10);
  const count = journal.counts.get("R/A");
  expect(count).toMatchObject({ entries: 2, ends: 2, total_ns: 40, min_ns: 20, max_ns: 20 });
  expect(count?.last).toEqual({ id: 0, name: "ok" });
});

test("errors are kept in the words in which they were told, the newest of them", () => {
  const journal = new Journal();
  const outcome = { id: 0, name: "lost" };
  const left = (sequence: number): HistoryEntry => ({
    sequence,
    t_ns: sequence,
    event: { type: "left", path: "R", outcome, error: { __exc__: "E", msg: `${sequence}` } },
  });
  const fine: HistoryEntry = { sequence: 1, t_ns: 1, event: { type: "left", path: "R", outcome } };
  journal.add([fine, ...Array.from({ length: 20_001 }, (_, at) => left(at + 2))], 20_003);
  expect([0, 1, 2].map((index) => journal.hasError(index))).toEqual([false, true, true]);
  expect([0, 1, 2].map((index) => journal.error(index))).toEqual([
    null,
    null,
    { __exc__: "E", msg: "3" },
  ]);
});

test("a long run stays, and only its oldest other events are given up", () => {
  const journal = new Journal();
  const line = (index: number): HistoryEntry => ({
    sequence: index,
    t_ns: index,
    event: { type: "log", path: "R", level: "info", stream: "stdout", message: String(index) },
  });
  journal.add(
    Array.from({ length: 20_002 }, (_, index) => line(index + 1)),
    20_003,
  );
  expect(journal.length).toBe(20_002);
  expect([journal.at(1), journal.at(2)?.sequence]).toEqual([undefined, 3]);
});

test("the machines that a run went by, its lives and what was dropped are kept, however long ago", () => {
  const journal = new Journal();
  const kept: readonly Event[] = [
    { type: "root", hash: "b", change: "" },
    { type: "resumed", life: 2, crash: { reason: "signal 9", active: [] }, policy: "abort" },
    { type: "dropped", path: "R/A" },
  ];
  const log: Event = { type: "log", path: "R", level: "info", stream: "stdout", message: "a" };
  const events = [...kept, ...Array.from({ length: 20_001 }, () => log)];
  journal.add(
    events.map((event, at) => ({ sequence: at + 1, t_ns: at, event })),
    events.length + 1,
  );
  expect([0, 1, 2, 3].map((index) => journal.other(index)?.type)).toEqual([
    "root",
    "resumed",
    "dropped",
    undefined,
  ]);
});

test("all other events are told in their order, those that are kept for good too", () => {
  const journal = new Journal();
  const log: Event = { type: "log", path: "R", level: "info", stream: "stdout", message: "a" };
  const events: readonly Event[] = [log, { type: "root", hash: "b", change: "" }, log];
  journal.add(
    events.map((event, at) => ({ sequence: at + 1, t_ns: at, event })),
    4,
  );
  expect(journal.others().map(([sequence, { type }]) => `${sequence} ${type}`)).toEqual([
    "1 log",
    "2 root",
    "3 log",
  ]);
});
