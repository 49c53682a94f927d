import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { MachineProblem, Right } from "../model/generated/protocol.ts";
import type { Start, Watch } from "../store/history/run.ts";
import { FIRST_SETTINGS } from "../store/page/settings.ts";
import { keptBreakpoints, newBreakpoint } from "../store/run/breakpoints.ts";
import { allCommands } from "./all.ts";
import { startRun } from "./run_start.ts";
import { type TestContextOptions, testContext } from "./testing/context.ts";

const MACHINE = "R hierarchy outcome done\n  A execution outcome ok";
const FILE = { project: "p", path: "drill" };

/** A machine in front of a server that notes what is started. */
function setUp(
  options: TestContextOptions & { readonly live?: boolean; readonly isFirst?: boolean } = {},
) {
  const context = testContext(MACHINE, options);
  const started: Start[] = [];
  const watch = { id: "r1", now: signal({ run: { id: "r1", name: "Drill", phase: "live" } }) };
  if (options.live) context.tab.run.value = watch as unknown as Watch;
  const runs = {
    all: signal([]),
    start: (start: Start) => {
      started.push(start);
      return Promise.resolve("r2");
    },
    watch: (id: string) => ({ id }),
  };
  const showRun = (id: string) => void context.record.push(`show ${id}`);
  Object.assign(context.page, { runs, showRun });
  keptBreakpoints(context.tab).value = [];
  context.page.settings.value = { ...FIRST_SETTINGS, knowsTimeline: options.isFirst !== true };
  return { context, started };
}

test("what lies on disk is started, with what was asked for, and shown", async () => {
  const { context, started } = setUp();
  expect(await startRun(context, { hold: true })).toEqual({ id: "r2" });
  expect(started).toEqual([{ machine: FILE, hold: true, breakpoints: [] }]);
  expect(context.record).toEqual(["show r2"]);
});

test("the first start in a browser brings the time line forward, later ones leave the panels", async () => {
  const { context } = setUp({ isFirst: true });
  await startRun(context);
  await startRun(context);
  expect(context.record).toEqual(["show r2", "show timeline", "show r2"]);
});

test("edits that are not saved are saved first, left out, or nothing is started", async () => {
  const saved = setUp({ changed: true, answers: ["save"] });
  await startRun(saved.context);
  expect(saved.context.record).toEqual([
    "ask Save before starting?",
    'POST /machines/m1/save {"overwrite":false}',
    "show r2",
  ]);
  const asIs = setUp({ changed: true, answers: ["as-is"] });
  await startRun(asIs.context);
  expect([asIs.started.length, asIs.context.record.length]).toEqual([1, 2]);
  const none = setUp({ changed: true });
  expect(await startRun(none.context)).toBeNull();
  expect(none.started).toEqual([]);
});

test("beside a run of the same machine that is not shown here another one is started only if it is meant", async () => {
  const { context, started } = setUp({ answers: [false, true] });
  const run = {
    id: "r7",
    name: "Drill",
    phase: "live",
    author: "bob",
    started_ms: 0,
    machine: FILE,
  };
  const other = { ...run, id: "r8", machine: { project: "p", path: "mill" } };
  Object.assign(context.page.runs, { all: signal([other]) });
  await startRun(context);
  Object.assign(context.page.runs, { all: signal([other, run]) });
  expect(await startRun(context)).toBeNull();
  await startRun(context);
  expect(started.length).toBe(2);
  expect(context.record.filter((line) => line.startsWith("ask"))).toEqual([
    "ask Start another run?",
    "ask Start another run?",
  ]);
});

test("beside a run in progress another one is started only if it is meant", async () => {
  const { context, started } = setUp({ live: true, answers: [false, true] });
  expect(await startRun(context)).toBeNull();
  await startRun(context);
  expect(started.length).toBe(1);
});

test("a machine with errors is started only if that is meant", async () => {
  const about = { path: "R/A", part: "script.py:2", rule: "ScriptOutcome" };
  const note = { ...about, severity: "note", message: "R/A: worth knowing" } as const;
  const error = { ...about, severity: "error", message: "R/A: no outcome" } as const;
  const started = async (problems: readonly MachineProblem[], answer: unknown) => {
    const { context, started } = setUp({ problems, answers: [answer] });
    await startRun(context);
    return [started.length, ...context.record];
  };
  expect(await started([note], null)).toEqual([1, "show r2"]);
  expect(await started([error], "start")).toEqual([1, "ask Start with an error?", "show r2"]);
  expect(await started([error, error], "show")).toEqual([
    0,
    "ask Start with 2 errors?",
    "show problems",
  ]);
  expect(await started([error], null)).toEqual([0, "ask Start with an error?"]);
});

test("breakpoints that are kept for the machine go along; conditions only with the right to edit", async () => {
  const plain = newBreakpoint(1, "R/A");
  const code = { ...newBreakpoint(2, "R/A"), condition: "True" };
  const idsWith = async (rights: readonly Right[]) => {
    const { context, started } = setUp({ rights });
    keptBreakpoints(context.tab).value = [plain, code];
    await startRun(context);
    return started[0]?.breakpoints?.map(({ id }) => id);
  };
  expect(await idsWith(["observe", "start", "edit"])).toEqual([1, 2]);
  expect(await idsWith(["observe", "start"])).toEqual([1]);
});

test("one state is run by a start that says what comes after it", async () => {
  const { context, started } = setUp({ selected: ["state:R/A"] });
  for (const id of ["run.start-here", "run.selected", "run.only-selected"] as const) {
    await allCommands().get(id)?.run(context, undefined);
  }
  const more = { machine: FILE, breakpoints: [], start_from: "R/A" };
  expect(started).toEqual([more, { ...more, afterwards: "hold" }, { ...more, afterwards: "stop" }]);
});
