import { signal } from "@preact/signals-core";
import { describe, expect, it } from "vitest";
import type { RunSummary, ServerStatus } from "../model/generated/protocol.ts";
import type { Link } from "../store/page/server.ts";
import { followRuns } from "./runs.ts";
import { FakeClock } from "./testing/fake_clock.ts";
import { FakeRun } from "./testing/fake_run.ts";

const UP: Extract<Link, { state: "up" }> = {
  state: "up",
  session: { user: "anna", role: "engineer", rights: [], version: "0", expires_ms: null },
  connection: 1,
};

function run(id: string, started_ms: number, events = 0): RunSummary {
  return { id, started_ms, events, phase: "live" } as RunSummary;
}

function setUp(isShown?: (run: string) => boolean) {
  const [server, clock] = [new FakeRun(), new FakeClock()];
  const serverStatus = signal<ServerStatus | null>(null);
  const tellStatus = (...all: readonly RunSummary[]) => {
    serverStatus.value = { files_revision: 1, machines: [], runs: [...all] };
  };
  let ids = 0;
  const newId = () => {
    ids += 1;
    return `id${ids}`;
  };
  const runs = followRuns({ server, clock, newId }, serverStatus, isShown);
  const shown = () => runs.all.value.map(({ id, events }) => `${id} ${events}`);
  return { server, clock, tellStatus, runs, shown };
}

async function settle(): Promise<void> {
  for (let turn = 0; turn < 20; turn += 1) await Promise.resolve();
}

describe("the runs of the server", () => {
  it("are asked for whenever there is a connection, and then told", async () => {
    const { server, tellStatus, shown } = setUp();
    expect(server.asked).toEqual([]);
    server.link.value = UP;
    server.first().answer([run("b", 2), run("a", 1)]);
    await settle();
    tellStatus(run("c", 3), run("a", 1, 7));
    expect(shown()).toEqual(["c 0", "b 0", "a 7"]);
    server.link.value = { state: "connecting" };
    server.link.value = { ...UP, connection: 2 };
    expect(server.asked).toEqual(["GET /runs", "GET /runs"]);
  });

  it("that were told while the list was on its way are no older than the list", async () => {
    const { server, tellStatus, shown } = setUp();
    server.link.value = UP;
    tellStatus(run("a", 1, 9), run("b", 2));
    server.first().answer([run("a", 1, 5)]);
    await settle();
    expect(shown()).toEqual(["b 0", "a 9"]);
  });

  it("are asked for again if they could not be had", async () => {
    const { server, clock, shown } = setUp();
    server.link.value = UP;
    server.first().refuse(503);
    await settle();
    clock.pass(2_000);
    server.first().answer([run("a", 1)]);
    await settle();
    expect(shown()).toEqual(["a 0"]);
  });

  it("that were removed stay away, whatever the server told before", async () => {
    const { server, tellStatus, runs, shown } = setUp();
    tellStatus(run("a", 1), run("b", 2));
    const watch = runs.watch("a");
    const removed = runs.remove("a");
    server.first().answer(null);
    await removed;
    expect(shown()).toEqual(["b 0"]);
    tellStatus(run("a", 1), run("b", 2, 3));
    expect(shown()).toEqual(["b 3"]);
    expect([server.count("run_status"), server.count("run_history")]).toEqual([0, 0]);
    expect(runs.watch("a")).not.toBe(watch);
  });

  it("are started once, however often the answer is lost", async () => {
    const { server, clock, runs, shown } = setUp();
    const started = runs.start({ machine: { project: "p", path: "m" } });
    const { body } = server.first();
    server.first().refuse(0);
    await settle();
    clock.pass(500);
    await settle();
    expect(server.first().body).toEqual(body);
    server.first().answer(run("m-1", 5));
    expect(await started).toBe("m-1");
    expect(shown()).toEqual(["m-1 0"]);
  });

  it("of a robot are started once, although the fate of the first request stays unknown", async () => {
    const { server, clock, runs } = setUp();
    const start = () => runs.startAtRobot("scout", { machine: { project: "p", path: "m" } });
    const lost = start().catch((error: unknown) => error);
    const { path, body } = server.first();
    expect(path).toBe("/robots/scout/runs");
    server.first().refuse(0);
    await settle();
    clock.pass(61_000);
    await settle();
    server.first().refuse(0);
    await settle();
    expect(String(await lost)).toMatch(/unknown whether it was carried out/);
    const again = start();
    expect(server.first().body).toEqual(body);
    server.first().answer({ run: "m-1", robot: "scout" });
    expect(await again).toBe("m-1");
    const other = start();
    expect(server.first().body).not.toEqual(body);
    server.first().answer({ run: "m-2", robot: "scout" });
    expect(await other).toBe("m-2");
  });

  it("that no one looks at any more are not watched for ever", () => {
    const { server, runs } = setUp((id) => id === "shown");
    const shown = runs.watch("shown");
    const left = Array.from({ length: 7 }, (_, number) => runs.watch(`r${number}`));
    expect(runs.watch("shown")).toBe(shown);
    expect(runs.watch("r6")).toBe(left[6]);
    expect([server.count("run_status"), server.count("run_history")]).toEqual([7, 7]);
    expect(runs.watch("r0")).not.toBe(left[0]);
    expect([server.count("run_status"), server.count("run_history")]).toEqual([7, 7]);
  });

  it("that were told something stay watched until they have answered", async () => {
    const { server, runs } = setUp();
    const first = runs.watch("first");
    const pending = first.command({ type: "stop" });
    for (let number = 0; number < 7; number += 1) runs.watch(`r${number}`);
    expect(runs.watch("first")).toBe(first);
    server.first().answer({ id: "id1", answer: "applied" });
    expect((await pending).answer).toEqual({ answer: "applied" });
  });

  it("are watched once", () => {
    const { server, runs } = setUp();
    expect(runs.watch("a")).toBe(runs.watch("a"));
    expect(server.count("run_history")).toBe(1);
  });
});
