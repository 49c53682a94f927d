import fc from "fast-check";
import { describe, expect, it } from "vitest";
import type { Document, Edit } from "../model/generated/protocol.ts";
import { sketch } from "../model/testing/sketch.ts";
import { anyEdit } from "../store/document/predict/testing/any_edit.ts";
import type { Telling } from "../store/page/notices.ts";
import { LibraryCache } from "./library_cache.ts";
import { OpenMachineSession } from "./machine_session.ts";
import { gatherReturnNews } from "./return_news.ts";
import { FakeClock } from "./testing/fake_clock.ts";
import { FakeServer, MACHINE } from "./testing/fake_server.ts";

const TEXT = `
  R "Root" hierarchy 0 0 400 300 outcome done input speed:int=3 scoped found:list
    A "Scan" execution 20 20 80 60 outcome ok outcome lost output pose:list
    B barrier 200 20 80 60 outcome ok input pose:list
      unique_decider_state_id decider outcome success
      C execution outcome ok
    R > A
    A.ok > B
    B.ok > R.done
    A.pose >> B.pose`;

function setUp(document: Document = sketch(TEXT), summary = MACHINE) {
  const server = new FakeServer(document);
  const notices: Telling[] = [];
  const libraryCache = new LibraryCache(server.request);
  const clock = new FakeClock();
  let count = 0;
  const tell = (notice: Telling) => void notices.push(notice);
  const session = new OpenMachineSession(
    summary,
    { revision: 1, document },
    {
      server,
      libraryCache,
      clock,
      newId: () => `own-${++count}`,
      tell,
      returnNews: gatherReturnNews(clock, tell),
    },
  );
  return { server, session, notices, libraryCache, clock };
}

/** Lets everything that was resolved go on. */
async function settle(): Promise<void> {
  for (let turn = 0; turn < 20; turn += 1) await Promise.resolve();
}

function documentOf({ machine }: OpenMachineSession): Document {
  const states = [...machine.paths()].flatMap((path) => machine.state(path) ?? []);
  return { header: machine.header, states };
}

const RENAME: Edit = { edit: "set_name", path: "R/A", name: "Look" };

describe("an open machine", () => {
  it("shows an edit at once, and keeps it when it is answered", async () => {
    const { server, session } = setUp();
    const answer = session.edit("Rename", RENAME);
    expect(session.machine.state("R/A")?.name).toBe("Look");
    expect(session.pending.value.map(({ name }) => name)).toEqual(["Rename"]);
    server.take();
    server.answer();
    await settle();
    expect(session.pending.value).toHaveLength(1);
    server.tell(1);
    expect(await answer).toEqual({ revision: 2 });
    expect(session.pending.value).toEqual([]);
    expect(session.machine.state("R/A")?.name).toBe("Look");
  });

  it("gives a step a name of at most 200 characters", () => {
    const { session } = setUp();
    void session.edit("x".repeat(200), RENAME);
    void session.edit("😀".repeat(201), RENAME);
    expect(session.pending.value.map(({ name }) => name)).toEqual([
      "x".repeat(200),
      "😀".repeat(200),
    ]);
  });

  it.each([
    [10_000, 2],
    [10_001, 3],
  ])("lists the last 10,000 of %i steps", (count, first) => {
    const { server, session } = setUp();
    const about = { id: "other", author: "ben", name: "Step", at_ms: 0, kind: "edit" } as const;
    const revisions = Array.from({ length: count }, (_, at) => {
      return { revision: at + 2, ...about, changes: [] };
    });
    server.news({ frame: "revisions", subscription: 1, revisions });
    const { steps } = session.steps.value;
    expect([steps.length, steps[0]?.revision, steps.at(-1)?.revision]).toEqual([
      10_000,
      first,
      count + 1,
    ]);
  });

  it("tells which states are different, and nothing when a prediction comes true", async () => {
    const { server, session } = setUp();
    const changes: (string[] | null)[] = [];
    session.onChange((touched) => changes.push(touched && [...touched]));
    void session.edit("Rename", RENAME);
    const shown = session.machine.state("R/A");
    server.take();
    server.tell(1);
    expect(changes).toEqual([["R/A"]]);
    expect(session.machine.state("R/A")).toBe(shown);
  });

  it("takes a refused edit back and says why", async () => {
    const { server, session, notices } = setUp();
    const before = documentOf(session);
    const answer = session.edit("Start", { edit: "remove_state", path: "R", state: "A" });
    expect(session.machine.state("R/A")).toBeUndefined();
    server.make("x", { edit: "remove_state", path: "R", state: "A" });
    server.take();
    server.answer();
    expect(await answer).toEqual({ refused: "it breaks a rule" });
    expect(documentOf(session)).toEqual(before);
    expect(notices).toEqual([
      {
        level: "warning",
        text: "Root: “Start” was not applied: it breaks a rule",
        about: { machine: "m", element: { kind: "state", path: "R" } },
      },
    ]);
  });

  it("is opened again when the server has forgotten it, and asks for its edits again", async () => {
    const { server, session, notices } = setUp();
    const answer = session.edit("Rename", RENAME);
    server.isOpen = false;
    server.take();
    server.answer();
    await settle();
    expect(server.asked).toContain("POST /machines/open");
    server.take();
    server.answer();
    server.tell(1);
    expect(await answer).toEqual({ revision: 2 });
    expect(notices).toEqual([]);
  });

  it("reports recovered edits after a restart, and not those that it is opened with", () => {
    const recovered = { ...MACHINE, is_changed: true, is_recovered: true };
    const opened = setUp(sketch(TEXT), recovered);
    opened.server.sendStatus(recovered);
    opened.clock.pass(10_000);
    expect(opened.notices).toEqual([]);
    const { server, clock, notices } = setUp();
    server.sendStatus(recovered);
    server.sendStatus(recovered);
    clock.pass(10_000);
    const text = "Unsaved edits from before the server ended are restored: “Root”.";
    expect(notices).toEqual([{ level: "info", text }]);
  });

  it("gets the whole machine when its history is gone", async () => {
    const { server, session } = setUp();
    server.make("x", { edit: "remove_state", path: "R", state: "A" });
    void session.edit("Rename", { edit: "set_name", path: "R/B", name: "Wait" });
    server.news({ frame: "reset", subscription: 1, revision: 2 });
    await settle();
    expect(session.machine.state("R/A")).toBeUndefined();
    expect(session.machine.state("R/B")?.name).toBe("Wait");
    expect(session.revision.value).toBe(2);
  });

  it("shows the content of a library once it was asked for, or says once why not", async () => {
    const text = "R hierarchy\n  L library library=tools/grip\n  M library library=tools/none";
    const { server, session, notices } = setUp(sketch(text));
    server.libraries.set("/libraries/tools/grip", sketch("G hierarchy\n  A execution"));
    const touched: (readonly string[] | null)[] = [];
    session.onChange((paths) => touched.push(paths && [...paths]));
    await session.loadLibrary("R/L");
    expect(session.machine.children("R/L/G")).toEqual(["R/L/G/A"]);
    expect(touched).toEqual([null]);
    for (const path of ["R/M", "R/M"]) await session.loadLibrary(path);
    expect(notices.map((notice) => notice.text)).toEqual([
      "R: the content of tools/none cannot be shown: there is no such library",
    ]);
  });

  it("looks for problems again when files have changed, whether or not it shows a library", async () => {
    const { server, libraryCache, clock } = setUp();
    const asked = () => server.asked.filter((path) => path.endsWith("/problems")).length;
    clock.pass(1_000);
    await settle();
    const before = asked();
    await libraryCache.refresh();
    clock.pass(1_000);
    await settle();
    expect(asked()).toBe(before + 1);
  });

  it("is checked once its problems were told, and not any more after an edit", async () => {
    const { server, session, clock } = setUp();
    const checked = async () => {
      const before = session.isChecked.value;
      clock.pass(1_000);
      await settle();
      return [before, session.isChecked.value];
    };
    expect(await checked()).toEqual([false, true]);
    server.make("x", RENAME);
    server.tell(1);
    expect(await checked()).toEqual([false, true]);
  });

  it("shows what the server has once nothing is on its way, whatever came in which order", async () => {
    const step = fc.record({
      what: fc.constantFrom("edit", "edit", "foreign", "take", "answer", "tell", "reset"),
      seed: fc.nat(),
    });
    const check = async (steps: readonly { readonly what: string; readonly seed: number }[]) => {
      const { server, session } = setUp();
      for (const { what, seed } of steps) {
        act(server, session, what, seed);
        await settle();
      }
      for (let turn = 0; turn < 500 && (turn === 0 || !server.isIdle); turn += 1) {
        server.take();
        server.answer();
        server.tell(10);
        await settle();
      }
      expect(session.pending.value).toEqual([]);
      expect(documentOf(session)).toEqual(server.document());
    };
    const steps = fc.array(step, { maxLength: 40 });
    await fc.assert(fc.asyncProperty(steps, check), { numRuns: 300 });
  });
});

function act(server: FakeServer, session: OpenMachineSession, what: string, seed: number): void {
  let state = seed;
  const pick = (bound: number) => {
    state = (Math.imul(state, 1_103_515_245) + 12_345) >>> 0;
    return (state >>> 8) % bound;
  };
  if (what === "edit") void session.edit("Edit", anyEdit(session.machine, pick));
  else if (what === "foreign") server.make(`foreign-${seed}`, anyEdit(server.model, pick));
  else if (what === "take") server.take();
  else if (what === "answer") server.answer();
  else if (what === "tell") server.tell(1 + (seed % 3));
  else server.news({ frame: "reset", subscription: 1, revision: server.revision });
}
