import { expect, test } from "vitest";
import { eventDetail } from "./event_details.ts";
import type { Runs } from "./run.ts";

test("an event is asked for once, and again after three hundred others", () => {
  const asked: string[] = [];
  const get = (_run: string, what: string) => {
    asked.push(what);
    return Promise.resolve({});
  };
  const runs = { get } as unknown as Runs;
  const ask = (from: number, to: number) => {
    for (let event = from; event <= to; event += 1) void eventDetail(runs, "r", event);
    return asked.filter((what) => what === "events/1").length;
  };
  expect([ask(1, 300), ask(1, 1), ask(301, 301), ask(1, 1), ask(1, 1)]).toEqual([1, 1, 1, 2, 2]);
});
