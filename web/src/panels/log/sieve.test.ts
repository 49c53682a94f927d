import { expect, test } from "vitest";
import type { LogLevel } from "../../model/generated/protocol.ts";
import { Journal } from "../../store/history/journal.ts";
import { RunLog } from "../../store/history/run_log.ts";
import { Sieve } from "./sieve.ts";

function setUp(least: LogLevel) {
  const journal = new Journal();
  let sequence = 0;
  const say = (level: LogLevel, message: string) => {
    sequence += 1;
    const event = { type: "log", path: "R", level, stream: "logger", message } as const;
    journal.add([{ sequence, t_ns: sequence * 1e6, event }], sequence + 1);
  };
  let visitCount = 0;
  const nameOf = () => {
    visitCount += 1;
    return "Root";
  };
  const wanted = { least, query: "o", states: null };
  const sieve = new Sieve(new RunLog({ id: "r", journal }), wanted, 1_000, nameOf);
  return { say, sieve, visitCount: () => visitCount };
}

test("wanted lines are added as the log grows, and the list is the same while nothing was", () => {
  const { say, sieve } = setUp("warning");
  say("warning", "one");
  say("info", "other");
  const first = sieve.rows();
  expect(first.map(({ text, at_ms }) => `${at_ms} ${text}`)).toEqual(["1001 one"]);
  say("debug", "foo");
  expect(sieve.rows()).toBe(first);
  say("error", "two");
  expect(sieve.rows().map(({ text }) => text)).toEqual(["one", "two"]);
});

test("each line is looked at once", () => {
  const { say, sieve, visitCount } = setUp("verbose");
  for (let each = 0; each < 5; each += 1) {
    say("info", "x");
    sieve.rows();
  }
  expect(visitCount()).toBe(5);
});
