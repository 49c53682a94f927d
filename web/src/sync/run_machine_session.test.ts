import { signal } from "@preact/signals-core";
import { describe, expect, it } from "vitest";
import type { Moment } from "../model/generated/protocol.ts";
import { sketch } from "../model/testing/sketch.ts";
import { RunMachineSession } from "./run_machine_session.ts";
import { followRuns } from "./runs.ts";
import { FakeClock } from "./testing/fake_clock.ts";
import { FakeRun } from "./testing/fake_run.ts";

const FIRST = sketch("R hierarchy\n  A execution");
const LATER = sketch("R hierarchy\n  A execution\n  B execution");

async function setUp() {
  const [server, clock] = [new FakeRun(), new FakeClock()];
  const runs = followRuns({ server, clock, newId: () => "id" }, signal(null));
  const watch = runs.watch("r");
  const entered = RunMachineSession.enter(watch, runs, { server, clock });
  server.first().answer(FIRST);
  const session = await entered;
  const children = () => session.machine.children("R").join(" ");
  /** Reports that the run uses another machine from now on. */
  const goBy = (hash: string) => {
    server.happen({ type: "root", hash, change: "" });
    server.tell(1);
    clock.pass(100);
  };
  return { server, clock, runs, watch, session, children, goBy };
}

async function settle(): Promise<void> {
  for (let turn = 0; turn < 20; turn += 1) await Promise.resolve();
}

describe("the machine of a run", () => {
  it("is the one that the run began with, and is not edited", async () => {
    const { session, children, server } = await setUp();
    expect(children()).toBe("R/A");
    expect(server.asked).toEqual(["GET /runs/r/machine"]);
    expect(await session.undo()).toHaveProperty("refused");
  });

  it("is another one as soon as the run goes by that", async () => {
    const { server, children, goBy } = await setUp();
    goBy("h1");
    server.first().answer(FIRST);
    await settle();
    goBy("h2");
    expect(server.first().path).toBe("/runs/r/machine?root=h2");
    server.first().answer(LATER);
    await settle();
    expect(children()).toBe("R/A R/B");
  });

  it("is the one that the run went by last, however much it has told since", async () => {
    const { server, clock, watch, session, runs } = await setUp();
    session.close();
    server.happen({ type: "root", hash: "h1", change: "" });
    const message = { level: "info", stream: "stdout", message: "a" } as const;
    for (let count = 0; count < 20_001; count += 1) {
      server.happen({ type: "log", path: "R", ...message });
    }
    server.tell(30_000);
    clock.pass(100);
    const entered = RunMachineSession.enter(watch, runs, { server, clock });
    server.first().answer(FIRST);
    await entered;
    expect(server.first().path).toBe("/runs/r/machine?root=h1");
  });

  it("is the one of the moment that is shown, and at the end the last again", async () => {
    const { server, watch, children, goBy } = await setUp();
    goBy("h1");
    server.first().answer(FIRST);
    await settle();
    goBy("h2");
    server.first().answer(LATER);
    await settle();
    watch.playhead.value = 1;
    server.first().answer({ sequence: 1, root: "h1" } as Moment);
    await settle();
    server.first().answer(FIRST);
    await settle();
    expect(children()).toBe("R/A");
    watch.playhead.value = null;
    expect(server.first().path).toBe("/runs/r/machine?root=h2");
    server.first().answer(LATER);
    await settle();
    expect(children()).toBe("R/A R/B");
  });

  it("is asked for again while it cannot be had, and the newest wins", async () => {
    const { server, clock, children, goBy } = await setUp();
    goBy("h1");
    server.first().refuse(0);
    await settle();
    clock.pass(1_000);
    goBy("h2");
    server.first().answer(FIRST);
    await settle();
    expect(children()).toBe("R/A");
    expect(server.first().path).toBe("/runs/r/machine?root=h2");
    server.first().answer(LATER);
    await settle();
    expect(children()).toBe("R/A R/B");
  });

  it("is not asked for any more once the session is closed", async () => {
    const { server, clock, session, goBy } = await setUp();
    goBy("h1");
    server.first().refuse(0);
    await settle();
    session.close();
    const count = server.asked.length;
    clock.pass(60_000);
    goBy("h2");
    expect(server.asked).toHaveLength(count);
  });
});
