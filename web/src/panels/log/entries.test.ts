import { describe, expect, it, test } from "vitest";
import type { LogLevel } from "../../model/generated/protocol.ts";
import type { Notice } from "../../store/page/page.ts";
import { entryOf, inOneLine, isWanted, type LogEntry, lineEntry, merged } from "./entries.ts";

const NOTICES: readonly Notice[] = [
  { id: 1, at_ms: 10, level: "info", count: 1, text: "Connected again" },
  { id: 2, at_ms: 20, level: "warning", count: 1, text: "Rename was not done" },
  { id: 3, at_ms: 30, level: "error", count: 1, text: "Not saved: disk full" },
];

function line(sequence: number, level: LogLevel, path: string, message: string): LogEntry {
  const t_ns = sequence * 1e6;
  return lineEntry({ sequence, t_ns, path, level, stream: "stdout", message }, 15);
}

const RUN = [
  line(1, "debug", "R", "begins"),
  line(2, "info", "R/A/B", "not bad"),
  line(7, "error", "R/AB", "is empty"),
];

const nameOf = (path: string) => ({ R: "Root", "R/A/B": "Grasp", "R/AB": "Look" })[path] ?? "";

function texts(wanted: {
  readonly least?: LogLevel;
  readonly query?: string;
  readonly states?: readonly string[];
}): readonly string[] {
  const whole = { least: "verbose", query: "", states: null, ...wanted } as const;
  const all = merged(RUN, NOTICES.map(entryOf));
  return all.filter((entry) => isWanted(entry, whole, nameOf)).map(({ text }) => text);
}

describe("the log", () => {
  it("has the lines of run and page by time", () => {
    expect(texts({})).toEqual([
      "Connected again",
      "begins",
      "not bad",
      "Rename was not done",
      "is empty",
      "Not saved: disk full",
    ]);
    expect(merged([], RUN)).toBe(RUN);
    expect(merged(RUN, [])).toBe(RUN);
  });

  it("is filtered by level", () => {
    expect(texts({ least: "warning" })).toEqual([
      "Rename was not done",
      "is empty",
      "Not saved: disk full",
    ]);
  });

  it("is searched by text and by the names of states", () => {
    expect(texts({ query: " NOT " })).toEqual([
      "not bad",
      "Rename was not done",
      "Not saved: disk full",
    ]);
    expect(texts({ query: "grasp" })).toEqual(["not bad"]);
  });

  it("shows what states said, and what is inside them", () => {
    expect(texts({ states: ["R/A"] })).toEqual(["not bad"]);
    expect(texts({ states: ["R"] })).toEqual(["begins", "not bad", "is empty"]);
    expect(texts({ states: ["R/A/B", "R/AB"], least: "error" })).toEqual(["is empty"]);
  });
});

const TRACEBACK = `Traceback (most recent call last):
  File "/m/x_X/script.py", line 3, in execute
    work()
  File "/lib/work.py", line 9, in work
    raise ValueError("no")
ValueError: no`;

test("a line of several is told in one: of a traceback what was raised, and where in the script", () => {
  expect(inOneLine("one")).toBe("one");
  expect(inOneLine("one\ntwo\nthree")).toBe("one … 3 lines");
  expect(inOneLine(TRACEBACK)).toBe("ValueError: no — script.py line 3");
  expect(inOneLine(`failed\n${TRACEBACK}`)).toBe("failed — ValueError: no — script.py line 3");
});
