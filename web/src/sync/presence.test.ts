import { signal } from "@preact/signals-core";
import { describe, expect, it } from "vitest";
import type { MachineStatus } from "../model/generated/protocol.ts";
import { sketch } from "../model/testing/sketch.ts";
import type { OpenTab } from "../store/page/page.ts";
import { newView, select } from "../store/page/view.ts";
import { tellPresence } from "./presence.ts";
import { FakeClock } from "./testing/fake_clock.ts";
import { FakeServer, MACHINE } from "./testing/fake_server.ts";

function setUp() {
  const server = new FakeServer(sketch("R hierarchy"));
  const clock = new FakeClock();
  const status = signal<MachineStatus>({ summary: MACHINE, people: [] });
  const tab = { session: { id: "m", status }, view: newView() } as unknown as OpenTab;
  const active = signal<OpenTab | null>(tab);
  tellPresence(server, () => active.value, clock);
  const listed = (connection: number) => {
    status.value = { summary: MACHINE, people: [{ connection, user: "anna", selection: [] }] };
  };
  const selections = () =>
    server.sent.map((frame) => (frame as { selection: string[] }).selection.join(" "));
  return { server, clock, tab, active, listed, selections };
}

describe("presence", () => {
  it("is told at once, then not more often than can be seen, and the last for sure", () => {
    const { clock, tab, listed, selections } = setUp();
    listed(1);
    for (const path of ["R/A", "R/B", "R/C"]) select(tab.view, [{ kind: "state", path }]);
    expect(selections()).toEqual([""]);
    clock.pass(50);
    expect(selections()).toEqual(["", "R/C"]);
    clock.pass(500);
    expect(selections()).toEqual(["", "R/C"]);
    select(tab.view, [{ kind: "outcome", path: "R/A", id: 0 }]);
    expect(selections()).toEqual(["", "R/C", "R/A"]);
  });

  it("is told again when the server has forgotten it", () => {
    const { clock, listed, selections } = setUp();
    listed(1);
    clock.pass(500);
    listed(2);
    expect(selections()).toEqual(["", ""]);
  });

  it("is told again over a new connection", () => {
    const { server, clock, listed, selections } = setUp();
    listed(1);
    clock.pass(500);
    const up = server.link.value;
    server.link.value = { state: "connecting" };
    if (up.state === "up") server.link.value = { ...up, connection: 2 };
    expect(selections()).toEqual(["", ""]);
  });

  it.each([
    ["a thousand states", 1, 1_001, 1_000],
    ["20,000 characters", 200, 101, 100],
  ])("tells of a large selection %s at most", (_, length, count, expected) => {
    const { server, clock, tab, listed, selections } = setUp();
    listed(1);
    clock.pass(500);
    const path = (at: number) => `R/${at}`.padEnd(length, "x");
    const states = Array.from({ length: count }, (_, at) => {
      return { kind: "state", path: path(at) } as const;
    });
    select(tab.view, states);
    clock.pass(50);
    expect((server.sent.at(-1) as { selection: string[] }).selection.length).toBe(expected);
    select(tab.view, states.slice(0, 2));
    clock.pass(50);
    expect(selections().at(-1)).toBe(`${path(0)} ${path(1)}`);
  });
});
