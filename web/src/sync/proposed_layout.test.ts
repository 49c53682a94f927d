import { expect, test } from "vitest";
import type { Edit } from "../model/generated/protocol.ts";
import { changed } from "../model/layout.ts";
import { readLayout } from "../model/layout_reader.ts";
import { sketch } from "../model/testing/sketch.ts";
import { isUndrawn } from "../model/undrawn.ts";
import { LibraryCache } from "./library_cache.ts";
import { OpenMachineSession } from "./machine_session.ts";
import { FakeClock } from "./testing/fake_clock.ts";
import { FakeServer, MACHINE } from "./testing/fake_server.ts";

const TEXT = `
  R hierarchy outcome done
    A execution outcome ok
    B execution outcome ok`;

function setUp() {
  const document = sketch(TEXT);
  const server = new FakeServer(document);
  let count = 0;
  const session = new OpenMachineSession(
    MACHINE,
    { revision: 1, document },
    {
      server,
      libraryCache: new LibraryCache(server.request),
      clock: new FakeClock(),
      newId: () => `own-${++count}`,
      tell: () => {},
      returnNews: { reloaded: () => {}, restored: () => {} },
    },
  );
  const at = (path: string) =>
    readLayout(session.machine.state(path) ?? { path: "", name: "", kind: "execution" }).position;
  return { server, session, at };
}

const box = (x: number) => ({ x, y: 10, width: 30, height: 20 });

function placing(path: string, x: number): Edit {
  const layout = changed(null, { position: box(x), size: box(x) });
  return { edit: "set_layout", path, layout };
}

const PROPOSED = {
  name: "Automatic layout",
  edit: { edit: "batch", edits: [placing("R/A", 10), placing("R/B", 50)] },
} as const satisfies { name: string; edit: Edit };

const RENAME: Edit = { edit: "set_name", path: "R/A", name: "Look" };

test("a proposed layout shows, and the machine has no edit", () => {
  const { session, server, at } = setUp();
  expect([isUndrawn(session.machine), session.proposal.isDue.value]).toEqual([true, true]);
  session.proposal.show(PROPOSED);
  expect(session.proposal.isDue.value).toBe(false);
  expect([at("R/A")?.x, at("R/B")?.x]).toEqual([10, 50]);
  expect(session.pending.value).toEqual([]);
  server.take();
  expect(server.revision).toBe(1);
});

test("the next edit keeps it, as a step before", () => {
  const { session, server, at } = setUp();
  session.proposal.show(PROPOSED);
  void session.edit("Rename", RENAME);
  expect(session.proposal.shown.value).toBe(null);
  expect(session.pending.value.map(({ name }) => name)).toEqual(["Automatic layout", "Rename"]);
  server.take();
  server.tell(2);
  expect([at("R/A")?.x, session.machine.state("R/A")?.name]).toEqual([10, "Look"]);
  expect(isUndrawn(server.model)).toBe(false);
});

test("edits of others leave it, until one of them draws the machine", () => {
  const { session, server, at } = setUp();
  session.proposal.show(PROPOSED);
  server.make("theirs", RENAME);
  server.tell(1);
  expect([at("R/B")?.x, session.machine.state("R/A")?.name]).toEqual([50, "Look"]);
  server.make("theirs-2", placing("R/A", 70));
  server.tell(1);
  expect([at("R/A")?.x, at("R/B")]).toEqual([70, undefined]);
  expect(session.proposal.shown.value).toBe(null);
});

test("what is kept twice is made once", async () => {
  const { session } = setUp();
  session.proposal.show(PROPOSED);
  void session.proposal.keep();
  await session.proposal.keep();
  expect(session.pending.value).toHaveLength(1);
});
