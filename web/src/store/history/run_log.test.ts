import { expect, test } from "vitest";
import type { Event, LogPage } from "../../model/generated/protocol.ts";
import { Journal } from "./journal.ts";
import { RunLog } from "./run_log.ts";

function line(text: string): Event {
  return { type: "log", path: "R/A", level: "info", stream: "stdout", message: text };
}

function setUp(count = 2) {
  const journal = new Journal();
  const all: Event[] = [];
  const happen = (...events: readonly Event[]) => {
    for (const event of events) {
      all.push(event);
      const sequence = all.length;
      journal.add([{ sequence, t_ns: sequence, event }], sequence + 1);
    }
  };
  const asked: string[] = [];
  /** Page size of the server, in lines. */
  const get = <T>(_: string, what: string): Promise<T> => {
    asked.push(what);
    const from = Number(/from=(\d+)/.exec(what)?.[1]);
    const lines = all.flatMap((event, index) =>
      event.type === "log" && index + 1 >= from ? [{ event, sequence: index + 1 }] : [],
    );
    const page = lines.slice(0, count).map(({ event, sequence }) => ({
      ...event,
      sequence,
      t_ns: sequence,
      names: "Root/A",
    }));
    const next = lines[count]?.sequence ?? all.length + 1;
    return Promise.resolve({ lines: page, next, last: all.length } as LogPage as T);
  };
  const log = new RunLog({ id: "r", journal });
  const texts = () => log.lines.map(({ message }) => message);
  return { happen, get, log, texts, asked };
}

const PASS: Event = { type: "entered", path: "R/A" };

test("lines come as the journal grows, each once", () => {
  const { happen, log, texts } = setUp();
  happen(line("one"), PASS, line("two"));
  log.update();
  log.update();
  happen({ type: "stopping" }, line("three"));
  log.update();
  expect(texts()).toEqual(["one", "two", "three"]);
  expect([log.from, log.age]).toEqual([1, 0]);
});

test("older lines than the journal has are asked for, without gap and without any line twice", async () => {
  const { happen, get, log, texts, asked } = setUp();
  happen(...Array.from({ length: 20_004 }, (_, index) => line(`${index + 1}`)));
  log.update();
  expect([log.from, texts()[0], texts().length]).toEqual([5, "5", 20_000]);
  await log.older({ get });
  expect(texts().slice(0, 6)).toEqual(["1", "2", "3", "4", "5", "6"]);
  expect([log.from, log.age]).toEqual([1, 1]);
  expect(asked).toEqual(["log?from=1&count=1000", "log?from=3&count=1000"]);
});

test("what was missed is no gap: only lines after it are here", () => {
  const { happen, log, texts } = setUp();
  happen(line("early"));
  log.update();
  happen(...Array.from({ length: 20_001 }, (_, index) => line(`${index}`)));
  log.update();
  expect([log.from, texts()[0], log.age]).toEqual([3, "1", 1]);
});

test("a long log loses its older half, and can have it again", () => {
  const { happen, log, texts } = setUp();
  for (let part = 0; part < 4; part += 1) {
    happen(...Array.from({ length: 9_000 }, (_, index) => line(`${part}.${index}`)));
    log.update();
  }
  expect([texts().length, log.from, texts()[0]]).toEqual([21_000, 15_001, "1.6000"]);
});

test("older lines that someone asked for stay until as many new ones have come", async () => {
  const { happen, get, log, texts } = setUp(1_000);
  for (let part = 0; part < 4; part += 1) {
    happen(...Array.from({ length: 8_000 }, (_, index) => line(`${part}.${index}`)));
    log.update();
  }
  const { from } = log;
  while (log.lines.length <= 30_000) await log.older({ get });
  expect(log.from).toBeLessThan(from);
  const first = texts()[0];
  log.update();
  happen(line("new"));
  log.update();
  expect([texts()[0], texts().at(-1)]).toEqual([first, "new"]);
});
