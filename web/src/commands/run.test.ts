import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { LinkRights, Right, Command as RunCommand } from "../model/generated/protocol.ts";
import type { Watch } from "../store/history/run.ts";
import { keptBreakpoints, newBreakpoint } from "../store/run/breakpoints.ts";
import { allCommands } from "./all.ts";
import { refusalOf } from "./command.ts";
import { cannotSetConditions } from "./run_points.ts";
import { type TestContext, testContext } from "./testing/context.ts";

const COMMANDS = allCommands();
const MACHINE = `
  R "Root" hierarchy outcome done
    A "Scan" execution outcome ok outcome lost
    B "Grip" execution outcome ok
    R > A
    A.ok > B
    B.ok > R.done
`;
const HELD = { path: "R", phase: "held", held: [{ next: "R/A", by: { type: "step" } }] };
const ALL: readonly Right[] = ["observe", "command", "start", "edit"];

interface Options {
  readonly rights?: readonly Right[];
  readonly status?: string;
  readonly phase?: string;
  readonly active?: readonly unknown[];
  readonly holder?: string | null;
  /** Rights of the station on the robot of the run. */
  readonly pairing?: LinkRights;
  readonly selected?: string;
  readonly answer?: unknown;
  readonly answers?: readonly unknown[];
}

/** A machine with a run in front of it, whose commands are recorded. */
function running(options: Options = {}): TestContext & { readonly commands: RunCommand[] } {
  const { rights = ALL, status = "running", phase = "live", active = [], holder = null } = options;
  const context = testContext(MACHINE, {
    rights,
    selected: [`state:${options.selected ?? "R/A"}`],
    answers: options.answers ?? [],
  });
  const commands: RunCommand[] = [];
  const link = { state: "up", session: { user: "anna", rights } };
  Object.assign(context.page.server, { link: signal(link) });
  const snapshot = { status, active, breakpoints: [], questions: [] };
  const robot = options.pairing && { robot: "scout", rights: options.pairing };
  const now = { run: { id: "r", phase }, snapshot, control: { holder }, robot };
  const watch = {
    id: "r",
    now: signal(now),
    playhead: signal(null),
    command: (runCommand: RunCommand) => {
      commands.push(runCommand);
      return Promise.resolve({ answer: options.answer ?? { answer: "applied" } });
    },
  };
  context.tab.run.value = watch as unknown as Watch;
  return { ...context, commands };
}

function why(context: TestContext, id: string, argument?: unknown): string | null {
  const command = COMMANDS.find(id);
  if (!command) throw new Error(`there is no ${id}`);
  return command.refusal?.(context, argument as undefined) ?? refusalOf(command, context);
}

async function settle(): Promise<void> {
  for (let turn = 0; turn < 20; turn += 1) await Promise.resolve();
}

test("what can be done goes by how the run stands, and says why not", () => {
  const goes = running();
  expect([why(goes, "run.pause"), why(goes, "run.step-mode")]).toEqual([null, null]);
  expect(why(goes, "run.resume")).toMatch(/is already running/);
  expect(why(goes, "run.into")).toMatch(/pause the run/);
  const held = running({ status: "stepping", active: [HELD] });
  expect([why(held, "run.into"), why(held, "run.back"), why(held, "run.resume")]).toEqual([
    null,
    null,
    null,
  ]);
  expect(why(held, "run.step-mode")).toMatch(/in step mode/);
  expect(why(running({ phase: "crashed" }), "run.pause")).toMatch(/resume it/);
  expect(why(running({ phase: "crashed" }), "run.resume-crashed")).toBeNull();
  expect(why(testContext(MACHINE), "run.pause")).toMatch(/no run is shown/);
});

test("who only looks commands nothing; who is not in control brings to rest, and no more", () => {
  const viewer = running({ rights: ["observe"] });
  expect(why(viewer, "run.pause")).toMatch(/role operator/);
  expect(why(viewer, "run.start")).toMatch(/role operator/);
  const other = running({ holder: "bob" });
  expect(why(other, "run.step-mode")).toMatch(/bob is in control/);
  expect([why(other, "run.pause"), why(other, "run.stop")]).toEqual([null, null]);
  expect(why(running({ holder: "anna" }), "run.step-mode")).toBeNull();
  expect(why(running({ rights: ["observe", "command"] }), "run.reload")).toMatch(/engineer/);
});

test("what the pairing of the station does not allow on the robot says how to allow it", () => {
  const sees = running({ pairing: "observe" });
  expect(why(sees, "run.pause")).toBe(
    "scout lets users of this station only see runs: pair again with `rafcon pair scout --rights command` on the robot",
  );
  expect(why(running({ pairing: "observe", phase: "crashed" }), "run.resume-crashed")).toMatch(
    /--rights command/,
  );
  const ended = running({ pairing: "observe", phase: "finished" });
  expect(why(ended, "run.start-again")).toMatch(/--rights command/);
  expect(why(ended, "run.start-from-history")).toMatch(/--rights command/);
  const commands = running({ pairing: "command" });
  expect(why(commands, "run.pause")).toBeNull();
  expect(why(commands, "run.reload")).toMatch(/only see and command runs.*--rights change/);
  expect(cannotSetConditions(commands)).toMatch(/--rights change/);
  const changes = running({ pairing: "change" });
  expect([why(changes, "run.pause"), cannotSetConditions(changes)]).toEqual([null, null]);
});

test("steps go to all branches, or to the one that is named", async () => {
  const held = running({ status: "stepping", active: [HELD] });
  COMMANDS.run("run.over", held);
  COMMANDS.run("run.over", held, "R/A");
  await settle();
  expect(held.commands).toEqual([
    { type: "step_over", branch: null },
    { type: "step_over", branch: "R/A" },
  ]);
});

test("a stop asks once; who was asked already is not asked again", async () => {
  const doubtful = running({ answers: [false] });
  COMMANDS.run("run.stop", doubtful);
  await settle();
  expect(doubtful.commands).toEqual([]);
  COMMANDS.run("run.stop", doubtful, "sure");
  await settle();
  expect(doubtful.commands).toEqual([{ type: "stop" }]);
});

test("a stop and a kill go to the run that the user was asked about, whatever is shown by then", async () => {
  const stopped = running({ answers: [true, true] });
  const [own, later] = [stopped.tab.run.peek(), running()];
  for (const id of ["run.stop", "run.kill"] as const) {
    COMMANDS.run(id, stopped);
    stopped.tab.run.value = later.tab.run.peek();
    await settle();
    stopped.tab.run.value = own;
  }
  expect(later.commands).toEqual([]);
  expect(stopped.commands).toEqual([{ type: "stop" }, { type: "kill" }]);
});

test("what wants a human is shown on the tab that shows its run already", async () => {
  const context = running();
  const { page, tab, record } = context;
  const own = { ...tab, run: signal({ ...tab.run.peek(), id: "other" } as Watch) };
  const showRun = (id: string) => Promise.resolve(void record.push(`run ${id}`));
  Object.assign(page, { tabs: signal([tab, own]), active: signal(tab), showRun });
  COMMANDS.run("mission.show", context, "other");
  await settle();
  expect(page.active.value).toBe(own);
  COMMANDS.run("mission.show", context, "third");
  await settle();
  expect(record).toEqual(["show mission", "run third", "show mission"]);
});

test("a command that is refused by the run says so", async () => {
  const refused = running({ answer: { answer: "refused", reason: "a script runs" } });
  COMMANDS.run("run.start-here", refused);
  await settle();
  expect(refused.commands).toEqual([{ type: "start", from: "R/A", data: [] }]);
  expect(refused.record).toContain("tell Start here: a script runs");
});

test("the outcome of a state is chosen where it stands still, or comes next", () => {
  const next = running({ status: "stepping", active: [HELD] });
  const command = COMMANDS.get("run.force-outcome");
  expect(why(next, "run.force-outcome")).toBeNull();
  expect(command?.choices?.(next).map(({ title }) => title)).toContain("lost");
  const other = running({ status: "stepping", active: [HELD], selected: "R/B" });
  expect(why(other, "run.force-outcome")).toMatch(/paused, waiting, or next/);
});

test("a breakpoint of a live run is the run's; its removal too", async () => {
  const goes = running();
  COMMANDS.run("run.breakpoint", goes, "R/B");
  await settle();
  const [runCommand] = goes.commands;
  expect(runCommand).toMatchObject({
    type: "set_breakpoint",
    breakpoint: { ...newBreakpoint(1, "R/B"), id: expect.any(Number) },
  });
});

test("interrupted scripts are decided about one by one, or all at once", () => {
  const waits = running({ active: [{ path: "R/A", phase: "interrupted", held: [] }] });
  const choices = COMMANDS.get("run.recover")?.choices?.(waits) ?? [];
  expect(choices.map(({ argument }) => argument)).toEqual([
    { path: "R/A", policy: "restart" },
    { path: "R/A", policy: "abort" },
  ]);
});

test("edits that touch an active state are taken once it is left, if the user wants", async () => {
  const answer = { answer: "refused", reason: "R/A is active" };
  const unwanted = running({ answer, answers: [false] });
  COMMANDS.run("run.reload", unwanted);
  await settle();
  expect(unwanted.record).toContain("ask The edits cannot be applied now");
  expect(unwanted.commands).toEqual([{ type: "reload", wait: false }]);
  const wanted = running({ answer, answers: [true] });
  COMMANDS.run("run.reload", wanted);
  await settle();
  expect(wanted.commands.at(-1)).toEqual({ type: "reload", wait: true });
});

test("a run that crashed is resumed by the rule that was chosen", async () => {
  const crashed = running({ phase: "crashed", answers: ["abort", null] });
  const policies: string[] = [];
  const resume = (policy: string) => Promise.resolve(void policies.push(policy));
  Object.assign(crashed.tab.run.peek() ?? {}, { resume });
  COMMANDS.run("run.resume-crashed", crashed);
  await settle();
  COMMANDS.run("run.resume-crashed", crashed, "restart");
  await settle();
  COMMANDS.run("run.resume-crashed", crashed);
  await settle();
  expect(policies).toEqual(["abort", "restart"]);
});

test("the machine of a run that is over is started again, once the user is sure", async () => {
  const over = running({ phase: "finished", answers: [false, true] });
  const shown: string[] = [];
  let starts = 0;
  const startAgain = () => {
    starts += 1;
    return Promise.resolve({ run: "r2", robot: null });
  };
  Object.assign(over.tab.run.peek() ?? {}, { startAgain });
  Object.assign(over.page, {
    active: signal(over.tab),
    showRun: (id: string) => Promise.resolve(void shown.push(id)),
  });
  expect(why(running(), "run.start-again")).toMatch(/still active/);
  expect(why(running({ phase: "finished", rights: ["observe"] }), "run.start-again")).toMatch(
    /only operators/,
  );
  COMMANDS.run("run.start-again", over);
  await settle();
  expect([starts, shown]).toEqual([0, []]);
  COMMANDS.run("run.start-again", over);
  await settle();
  expect([starts, shown]).toEqual([1, ["r2"]]);
});

test("what a robot starts again is shown once its first events arrive", async () => {
  const over = running({ phase: "finished", answers: [true] });
  const runs = signal<readonly { readonly id: string }[]>([]);
  const shown: string[] = [];
  const startAgain = () => Promise.resolve({ run: "r2", robot: "scout" });
  const watch = over.tab.run.peek();
  Object.assign(watch ?? {}, {
    startAgain,
    whenClosed: () => {},
    now: signal({ run: { id: "r", name: "Drill", phase: "finished", robot: "scout" } }),
  });
  Object.assign(over.page, {
    active: signal(over.tab),
    runs: { all: runs },
    showRun: (id: string) => Promise.resolve(void shown.push(id)),
  });
  COMMANDS.run("run.start-again", over);
  await settle();
  expect(shown).toEqual([]);
  runs.value = [{ id: "r2" }];
  await settle();
  expect(shown).toEqual(["r2"]);
});

test("a machine of a robot is started and shown once its first events arrive, unless the user has gone elsewhere", async () => {
  const file = { robot: "scout", machine: { project: "missions", path: "drive" } };
  const context = running({ phase: "finished", answers: [null, file, file] });
  expect(why(context, "run.start-at-robot")).toMatch(/not the station/);
  const runs = signal<readonly { readonly id: string }[]>([]);
  const started: unknown[] = [];
  const shown: string[] = [];
  const active = signal<unknown>(context.tab);
  const startAtRobot = (robot: string, { machine }: { machine: unknown }) => {
    started.push([robot, machine]);
    return Promise.resolve(`r${started.length}`);
  };
  Object.assign(context.page, {
    active,
    robots: signal(["scout"]),
    runs: { all: runs, startAtRobot },
    showRun: (id: string) => Promise.resolve(void shown.push(id)),
  });
  expect(why(context, "run.start-at-robot")).toBeNull();
  COMMANDS.run("run.start-at-robot", context);
  await settle();
  expect(started).toEqual([]);
  COMMANDS.run("run.start-at-robot", context);
  await settle();
  expect([started, shown]).toEqual([[["scout", file.machine]], []]);
  runs.value = [{ id: "r1" }];
  await settle();
  expect(shown).toEqual(["r1"]);
  COMMANDS.run("run.start-at-robot", context);
  await settle();
  active.value = null;
  runs.value = [{ id: "r1" }, { id: "r2" }];
  await settle();
  expect([started.length, shown]).toEqual([2, ["r1"]]);
});

test("a run that is over begins again at an entry of its history, for whoever may start runs", async () => {
  const over = running({ phase: "finished" });
  const begun: unknown[] = [];
  const resume = (...how: readonly unknown[]) => Promise.resolve(void begun.push(how));
  Object.assign(over.tab.run.peek() ?? {}, { resume });
  expect(why(over, "run.start-from-history")).toBeNull();
  COMMANDS.run("run.start-from-history", over, 7);
  await settle();
  expect(begun).toEqual([["restart", 7]]);
  const operator = running({ phase: "finished", rights: ["observe"] });
  expect(why(operator, "run.start-from-history")).toMatch(/start runs/);
  expect(why(running({ phase: "not_started" }), "run.start-from-history")).toMatch(/did not start/);
});

test("breakpoints are edited in a dialog, all removed at once, and switched for a state by a path alone", async () => {
  const kept = newBreakpoint(1, "R/A");
  const context = running({ phase: "finished", answers: [{ ...kept, when: "after" }] });
  const all = keptBreakpoints(context.tab);
  all.value = [];
  COMMANDS.run("run.breakpoint", context, "R/A");
  await settle();
  expect(all.value).toEqual([kept]);
  COMMANDS.run("run.edit-breakpoint", context, kept);
  await settle();
  expect(all.value).toEqual([{ ...kept, when: "after" }]);
  COMMANDS.run("run.clear-breakpoints", context);
  await settle();
  expect(all.value).toEqual([]);
  expect(why(context, "run.clear-breakpoints")).toMatch(/no breakpoints/);
  expect(context.commands).toEqual([]);
});
