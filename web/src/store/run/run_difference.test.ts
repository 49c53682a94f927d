import { signal } from "@preact/signals-core";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { Journal } from "../history/journal.ts";
import type { Runs, Watch } from "../history/run.ts";
import type { OpenTab } from "../page/page.ts";
import { RefusalError } from "../page/server.ts";
import { differsFromRun } from "./run_difference.ts";

const RAN = "R hierarchy outcome done\n  A execution 10 10 80 60 outcome ok";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

/** A tab with the machine of this text, and a run that uses `RAN` and, from root `h` on, `reloaded`. */
function setUp(text: string, reloaded = RAN, hasBegun = true) {
  let changed = () => {};
  const session = {
    fixed: null,
    machine: machineOf(sketch(text)),
    onChange: (listener: () => void) => {
      changed = listener;
      return () => {};
    },
  };
  const asked: string[] = [];
  let refusals = 0;
  const refuse = (count: number) => {
    refusals = count;
  };
  const runs = {
    get: (_run: string, what: string) => {
      asked.push(what);
      refusals -= 1;
      if (refusals >= 0) {
        return Promise.reject(new RefusalError({ code: "down", message: "no" }, 503));
      }
      return Promise.resolve(sketch(what === "machine" ? RAN : reloaded));
    },
  } as unknown as Runs;
  const journal = new Journal();
  const journalVersion = signal(0);
  const watch = { id: "r", journal, journalVersion } as unknown as Watch;
  const begin = () => {
    const event = { type: "paused", paused: false } as const;
    journal.add([{ sequence: journal.next, t_ns: 0, event }], journal.next + 1);
    journalVersion.value = journal.length;
  };
  if (hasBegun) begin();
  const differs = differsFromRun({ session } as unknown as OpenTab, watch, runs);
  const edit = (next: string) => {
    session.machine = machineOf(sketch(next));
    changed();
  };
  const reload = () => {
    const sequence = journal.next;
    const event = { type: "root", hash: "h", change: "Rename" } as const;
    journal.add([{ sequence, t_ns: 1, event }], sequence + 1);
    journalVersion.value = journal.length;
  };
  /** Adds log lines. */
  const chatter = (count: number) => {
    const from = journal.next;
    const event = {
      type: "log",
      path: "R",
      level: "info",
      stream: "stdout",
      message: "a",
    } as const;
    const entries = Array.from({ length: count }, (_, at) => ({
      sequence: from + at,
      t_ns: 1,
      event,
    }));
    journal.add(entries, from + count);
    journalVersion.value = journal.length;
  };
  const grow = () => {
    journalVersion.value += 1;
  };
  return { differs, edit, reload, chatter, asked, refuse, grow, begin };
}

async function settle(): Promise<void> {
  await vi.advanceTimersByTimeAsync(500);
}

test("an edit makes the machine another one than that of the run; to move a state does not", async () => {
  const { differs, edit } = setUp(RAN);
  const stop = differs.subscribe(() => {});
  await settle();
  expect(differs.value).toBe(false);
  edit(RAN.replace("10 10", "40 10"));
  await settle();
  expect(differs.value).toBe(false);
  edit(RAN.replace("outcome ok", "outcome well"));
  await settle();
  expect(differs.value).toBe(true);
  stop();
});

test("once the run has taken the edits the two are the same", async () => {
  const now = RAN.replace("outcome ok", "outcome well");
  const { differs, reload, asked } = setUp(now, now);
  const stop = differs.subscribe(() => {});
  await settle();
  expect(differs.value).toBe(true);
  reload();
  await settle();
  expect(differs.value).toBe(false);
  expect(asked).toEqual(["machine", "machine?root=h"]);
  stop();
});

test("a machine that cannot be had is asked for again after a while, however fast the run grows", async () => {
  const { differs, asked, refuse, grow } = setUp(RAN.replace("outcome ok", "outcome well"));
  refuse(1);
  const stop = differs.subscribe(() => {});
  for (let times = 0; times < 5; times += 1) grow();
  await settle();
  for (let times = 0; times < 5; times += 1) grow();
  expect(asked).toHaveLength(1);
  await vi.advanceTimersByTimeAsync(2_000);
  expect([asked.length, differs.value]).toEqual([2, true]);
  stop();
  await vi.advanceTimersByTimeAsync(60_000);
  expect(asked).toHaveLength(2);
});

test("the machine of a run is asked for when something was told of the run, and not before", async () => {
  const { differs, asked, begin } = setUp(RAN, RAN, false);
  const stop = differs.subscribe(() => {});
  await settle();
  expect(asked).toEqual([]);
  begin();
  await settle();
  expect(asked).toEqual(["machine"]);
  stop();
});

test("the edits that a run took long ago are still known to who begins to look", async () => {
  const now = RAN.replace("outcome ok", "outcome well");
  const { differs, reload, chatter, asked } = setUp(now, now);
  reload();
  chatter(20_001);
  const stop = differs.subscribe(() => {});
  await settle();
  expect([differs.value, asked]).toEqual([false, ["machine?root=h"]]);
  stop();
});
