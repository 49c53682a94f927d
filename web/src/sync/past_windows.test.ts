import { expect, test } from "vitest";
import { Journal } from "../store/history/journal.ts";
import { PastWindows } from "./past_windows.ts";
import { FakeClock } from "./testing/fake_clock.ts";

test("of more than four earlier parts the one shown longest ago goes", () => {
  const ask = () => Promise.reject(new Error("nothing is asked for"));
  const windows = new PastWindows({ clock: new FakeClock(), ask, changed: () => {} });
  const part = (sequence: number) => {
    const before = { sequence, t_ns: 0, active: [] };
    const journal = new Journal({ before, earlier: null });
    journal.add([], sequence + 11);
    return journal;
  };
  const here = () => [15, 115, 215, 315, 415].filter((sequence) => windows.at(sequence) !== null);
  for (const sequence of [10, 110, 210, 310]) windows.keep(part(sequence));
  expect(here()).toEqual([15, 115, 215, 315]);
  windows.want(15);
  windows.keep(part(410));
  expect(here()).toEqual([15, 215, 315, 415]);
});
