import fc from "fast-check";
import { describe, expect, it } from "vitest";
import type {
  Answer,
  EarlierState,
  HistoryEntry,
  Moment,
  RunNow,
  RunSummary,
} from "../model/generated/protocol.ts";
import { FakeClock } from "./testing/fake_clock.ts";
import { FakeRun } from "./testing/fake_run.ts";
import { RunWatch } from "./watch.ts";

function setUp() {
  const [server, clock] = [new FakeRun(), new FakeClock()];
  let ids = 0;
  const newId = () => {
    ids += 1;
    return `id${ids}`;
  };
  const watch = new RunWatch("r", { server, clock, newId });
  return { server, clock, watch };
}

function count(path: string, entries: number): EarlierState {
  const entered = { sequence: 1, t_ns: 1 };
  return { path, entries, ends: 0, total_ns: 0, min_ns: 0, max_ns: 0, entered, left: null };
}

async function settle(): Promise<void> {
  for (let turn = 0; turn < 20; turn += 1) await Promise.resolve();
}

function happen(server: FakeRun, count: number): void {
  for (let each = 0; each < count; each += 1) server.happen({ type: "entered", path: `R/${each}` });
}

function now(phase: "live" | "crashed" | "finished", disk_safe: number): RunNow {
  const run = { phase, id: "r" } as RunSummary;
  return { run, snapshot: { disk_safe } } as RunNow;
}

function sequences({ journal }: RunWatch): readonly number[] {
  return Array.from({ length: journal.length }, (_, index) => journal.sequence(index));
}

describe("a long run", () => {
  const COUNT = 1_000_000;
  const TURNS = [
    { type: "entered", path: "R/A" },
    { type: "left", path: "R/A", outcome: { id: 0, name: "ok" } },
  ] as const;

  /** Its window that is asked for. */
  function windowFrom(from: number, count: number) {
    const entry = (sequence: number): HistoryEntry => {
      return { sequence, t_ns: sequence * 1e6, event: { type: "entered", path: "R/A" } };
    };
    const events = Array.from({ length: count }, (_, at) => entry(from + at));
    const before = { sequence: from - 1, t_ns: 0, active: [] };
    return { before, events, next: from + count, last: COUNT };
  }

  it("is told from its newest events on, and what had been before is learnt", async () => {
    const { server, clock, watch } = setUp();
    server.skipped(COUNT, [{ path: "R", sequence: 1, t_ns: 5 }]);
    expect([watch.journal.from, watch.journal.first]).toEqual([COUNT + 1, 1]);
    const states = [count("R", 1), count("R/A", 7)];
    expect(server.asked.at(-1)).toBe(`GET /runs/r/earlier/${COUNT}`);
    server.first().answer({ sequence: COUNT, states, notable: [] });
    await settle();
    clock.pass(100);
    expect(watch.journal.counts.get("R/A")?.entries).toBe(7);
    expect(watch.window).toBe(watch.journal);
  });

  it("shows an earlier moment from the part around it, however one comes and goes", async () => {
    const { server, clock, watch } = setUp();
    server.skipped(COUNT, []);
    server.first().answer({ sequence: COUNT, states: [], notable: [] });
    await settle();
    watch.playhead.value = 600_000;
    const asked = server.waiting.find(({ path }) => path.includes("window"));
    expect(asked?.path).toBe("/runs/r/window?from=595000&count=10000");
    watch.playhead.value = 20_000;
    asked?.answer(windowFrom(595_000, 10_000));
    await settle();
    const next = server.waiting.find(({ path }) => path.includes("window"));
    expect(next?.path).toBe("/runs/r/window?from=15000&count=10000");
    next?.answer(windowFrom(15_000, 10_000));
    await settle();
    clock.pass(100);
    expect([watch.window.from, watch.window.covers(20_000)]).toEqual([15_000, true]);
    watch.playhead.value = 600_001;
    expect(watch.window.from).toBe(595_000);
    watch.playhead.value = null;
    expect(watch.window).toBe(watch.journal);
  });

  it("stays bounded while it grows, and what is shown stays though it is long ago", () => {
    const { server, watch } = setUp();
    happen(server, 10);
    server.tell(10);
    watch.playhead.value = 5;
    const shown = watch.window;
    for (let each = 0; each < 250_000; each += 1) server.happen(TURNS[each % 2] ?? TURNS[0]);
    for (let part = 0; part < 50; part += 1) server.tell(5_000);
    expect(watch.journal.length).toBeLessThan(200_001);
    expect(watch.journal.next).toBe(250_011);
    expect(watch.window.sequence(4)).toBe(5);
    expect(watch.window).toBe(shown);
  });
});

describe("the history of a run", () => {
  const deeds = fc.array(
    fc.oneof(
      fc.record({ deed: fc.constant("happen" as const), count: fc.nat(9) }),
      fc.record({ deed: fc.constant("tell" as const), count: fc.integer({ min: 1, max: 7 }) }),
      fc.record({ deed: fc.constant("break" as const), count: fc.nat(1) }),
      fc.record({ deed: fc.constant("repeat" as const), count: fc.integer({ min: 1, max: 20 }) }),
      fc.record({ deed: fc.constant("end" as const), count: fc.nat(1) }),
    ),
    { maxLength: 60 },
  );

  it("is there once and whole, however it is cut and whatever comes twice", () => {
    fc.assert(
      fc.property(deeds, (all) => {
        const { server, watch } = setUp();
        for (const { deed, count } of all) {
          if (deed === "happen") happen(server, count);
          else if (deed === "tell") server.tell(count);
          else if (deed === "break") server.breakUp();
          else if (deed === "repeat") server.repeat(count, 5);
          else {
            server.end("run_history");
            server.setStatus(now("live", server.events.length));
          }
        }
        server.tell(Number.POSITIVE_INFINITY);
        expect(sequences(watch)).toEqual(server.events.map(({ sequence }) => sequence));
        expect(server.count("run_history")).toBe(1);
      }),
    );
  });

  it("is caught up once the end was told, and again after each break", () => {
    const { server, clock, watch } = setUp();
    happen(server, 5);
    server.tell(3);
    expect(watch.isCaughtUp.value).toBe(false);
    server.tell(3);
    server.tell(3);
    expect(watch.isCaughtUp.value).toBe(true);
    expect(watch.journalVersion.value).toBe(0);
    clock.pass(100);
    expect(watch.journalVersion.value).toBe(5);
    server.breakUp();
    expect(watch.isCaughtUp.value).toBe(false);
    server.tell(3);
    expect(watch.isCaughtUp.value).toBe(true);
  });

  it("continues when a run that was over is resumed", () => {
    const { server, watch } = setUp();
    happen(server, 2);
    server.tell(2);
    server.end("run_history");
    server.setStatus(now("finished", 2));
    expect(server.count("run_history")).toBe(0);
    happen(server, 1);
    server.setStatus(now("live", 2));
    server.tell(9);
    expect(sequences(watch)).toEqual([1, 2, 3]);
  });

  it("is fetched to its end if there is more than was told", () => {
    const { server, watch } = setUp();
    happen(server, 2);
    server.tell(1);
    server.end("run_history");
    server.setStatus(now("finished", 2));
    server.tell(1);
    expect(sequences(watch)).toEqual([1, 2]);
  });

  it("says why it cannot be had, and is tried again where that may help", () => {
    const { server, clock, watch } = setUp();
    server.end("run_history", { code: "busy", message: "the disk is busy" });
    expect(watch.lack.value).toBe("the disk is busy");
    clock.pass(1_000);
    happen(server, 1);
    server.tell(1);
    expect([watch.lack.value, sequences(watch)]).toEqual([null, [1]]);
    server.end("run_history", { code: "journal_too_short", message: "it ends before event 7" });
    clock.pass(60_000);
    expect(server.count("run_history")).toBe(0);
    expect(watch.lack.value).toBe("it ends before event 7");
  });

  it("is not asked for any more once no one watches", () => {
    const { server, clock, watch } = setUp();
    server.end("run_status", { code: "busy", message: "busy" });
    watch.close();
    clock.pass(10_000);
    expect([server.count("run_history"), server.count("run_status")]).toEqual([0, 0]);
  });

  it("the truth is followed again after a refusal that may pass", () => {
    const { server, clock, watch } = setUp();
    server.end("run_status", { code: "busy", message: "busy" });
    clock.pass(1_000);
    server.setStatus(now("live", 0));
    expect([watch.now.value?.run.phase, watch.isCurrent.value]).toEqual(["live", true]);
  });
});

describe("the truth about a run", () => {
  it("is proven until the server was heard last over the connection that told it, and not by a new one", () => {
    const { server, watch } = setUp();
    const receiveAt = (server_ms: number) => {
      const times = { heard_ms: 0, delay_ms: 2, ahead_ms: 0, old_ms: 4_000 };
      server.pulse.value = { ...times, server_ms };
    };
    receiveAt(5_000);
    server.setStatus({ ...now("live", 0), now_ms: 4_000 });
    expect(watch.proven_ms.value).toBe(5_000);
    receiveAt(9_000);
    server.breakUp();
    receiveAt(90_000);
    server.breakUp();
    expect(watch.proven_ms.value).toBe(9_000);
    server.setStatus({ ...now("live", 0), now_ms: 91_000 });
    expect(watch.proven_ms.value).toBe(91_000);
  });

  it("counts as heard once it came over the connection that there is", () => {
    const { server, watch } = setUp();
    expect(watch.isCurrent.value).toBe(false);
    server.setStatus(now("live", 0));
    expect(watch.isCurrent.value).toBe(true);
    server.breakUp();
    expect(watch.isCurrent.value).toBe(false);
    server.setStatus(now("live", 0));
    expect(watch.isCurrent.value).toBe(true);
  });
});

describe("a command", () => {
  const PAUSE = { type: "pause" } as const;
  const APPLIED = { id: "id1", answer: "applied" };

  it("is under way until it is answered, and expires by the server's clock", async () => {
    const { server, clock, watch } = setUp();
    const heard_ms = clock.now();
    const pulse = { heard_ms, delay_ms: 2, ahead_ms: 5_000, server_ms: heard_ms, old_ms: 4_000 };
    server.pulse.value = pulse;
    const sent_ms = clock.now();
    const sending = watch.command(PAUSE, 3_000);
    const expiry_ms = sent_ms + 3_000;
    const begun = {
      id: "id1",
      command: PAUSE,
      sent_ms,
      expiry_ms,
      answer: null,
      answered_ms: null,
    };
    expect(watch.sent.value).toEqual([begun]);
    expect(server.first().path).toBe("/runs/r/commands");
    const expiry = expiry_ms + 5_000;
    const body = { id: "id1", author: "", decided_on: 0, expiry, command: PAUSE };
    expect(server.first().body).toEqual(body);
    clock.pass(1_000);
    server.first().answer(APPLIED);
    expect((await sending).answer).toEqual({ answer: "applied" });
    const answered_ms = sent_ms + 1_000;
    expect(watch.sent.value).toEqual([{ ...begun, answer: { answer: "applied" }, answered_ms }]);
  });

  it("is sent again with the same id until it is answered", async () => {
    const { server, clock, watch } = setUp();
    const sending = watch.command(PAUSE);
    for (const status of [0, 503, 502, 429, 0]) {
      server.first().refuse(status);
      await settle();
      expect(watch.sent.value[0]?.answer).toBe(null);
      clock.pass(500);
      await settle();
      expect(server.first().body).toMatchObject({ id: "id1", command: PAUSE });
    }
    server.first().answer({ id: "id1", answer: "expired" });
    expect((await sending).answer).toEqual({ answer: "expired" });
    expect(server.asked).toHaveLength(6);
  });

  it("that was refused at once was never carried out", async () => {
    const { server, watch } = setUp();
    const sending = watch.command(PAUSE);
    server.first().refuse(409, "anna is in control");
    expect((await sending).answer).toEqual({ answer: "refused", reason: "anna is in control" });
  });

  it("that is refused after an answer was lost has a fate that no one knows", async () => {
    const { server, clock, watch } = setUp();
    const sending = watch.command(PAUSE);
    server.first().refuse(0);
    await settle();
    clock.pass(500);
    await settle();
    server.first().refuse(409, "anna is in control");
    expect((await sending).answer).toEqual({ answer: "lost", reason: "anna is in control" });
  });

  it("is lost long after no one could say what became of it", async () => {
    const { server, clock, watch } = setUp();
    const sending = watch.command(PAUSE, 0);
    clock.pass(600_001);
    server.first().refuse(0, "no answer");
    expect((await sending).answer).toEqual({ answer: "lost", reason: "no answer" });
  });

  it("has the answer that stands in the run's history, also after it was lost", async () => {
    const { server, clock, watch } = setUp();
    const recorded = (id: string, answer: Answer) => {
      const envelope = { id: `anna/${id}`, author: "anna", decided_on: 0, expiry: 0 };
      server.happen({ type: "commanded", envelope: { ...envelope, command: PAUSE }, answer });
      server.tell(1);
    };
    const sending = watch.command(PAUSE);
    recorded("id1", { answer: "applied" });
    expect((await sending).answer).toEqual({ answer: "applied" });
    const lost = watch.command(PAUSE, 0);
    clock.pass(600_001);
    server.waiting.at(-1)?.refuse(0);
    expect((await lost).answer?.answer).toBe("lost");
    recorded("id2", { answer: "expired" });
    expect(watch.sent.value.at(-1)?.answer).toEqual({ answer: "expired" });
  });

  it("is remembered with the last ones that were answered", async () => {
    const { server, watch } = setUp();
    const never = watch.command(PAUSE);
    for (let each = 0; each < 60; each += 1) {
      const sending = watch.command(PAUSE);
      server.waiting.at(-1)?.answer(APPLIED);
      await sending;
    }
    expect(watch.sent.value).toHaveLength(51);
    expect(watch.sent.value[0]).toMatchObject({ id: "id1", answer: null });
    server.first().answer(APPLIED);
    await never;
    expect(watch.sent.value).toHaveLength(50);
  });
});

describe("a moment", () => {
  const picture = (sequence: number) => ({ sequence }) as Moment;
  const seen = (watch: RunWatch) => watch.playheadSnapshot.value?.picture.sequence ?? null;

  it("that is wanted last is shown, whatever answers come late", async () => {
    const { server, watch } = setUp();
    watch.playhead.value = 5;
    watch.playhead.value = 6;
    watch.playhead.value = 7;
    expect(server.asked).toEqual(["GET /runs/r/moments/5"]);
    server.first().answer(picture(5));
    await settle();
    expect(seen(watch)).toBe(null);
  });

  it("is asked for when the one before has come", async () => {
    const { server, clock, watch } = setUp();
    watch.playhead.value = 5;
    watch.playhead.value = 7;
    server.first().answer(picture(5));
    await settle();
    clock.pass(0);
    expect(server.first().path).toBe("/runs/r/moments/7");
    server.first().answer(picture(7));
    await settle();
    expect(seen(watch)).toBe(7);
    clock.pass(60_000);
    expect(server.asked).toHaveLength(2);
  });

  it("stays for a wink while the next one comes, and no longer", async () => {
    const { server, clock, watch } = setUp();
    watch.playhead.value = 5;
    server.first().answer(picture(5));
    await settle();
    watch.playhead.value = 7;
    expect(seen(watch)).toBe(5);
    clock.pass(300);
    expect(seen(watch)).toBe(null);
    watch.playhead.value = null;
    expect(seen(watch)).toBe(null);
  });

  it("is asked for again while the server is not there, and given up if there is none", async () => {
    const { server, clock, watch } = setUp();
    watch.playhead.value = 5;
    server.first().refuse(503);
    await settle();
    expect(watch.playhead.value).toBe(5);
    clock.pass(500);
    server.first().refuse(404);
    await settle();
    expect(watch.playhead.value).toBe(null);
  });

  it("is gone when the page goes live, however late its picture comes", async () => {
    const { server, watch } = setUp();
    watch.playhead.value = 5;
    watch.playhead.value = null;
    server.first().answer(picture(5));
    await settle();
    expect(seen(watch)).toBe(null);
  });

  it("with live values is asked for once a second, only while someone wants it and something happens", async () => {
    const { server, clock, watch } = setUp();
    happen(server, 3);
    server.tell(3);
    const stops = [watch.wantValues(), watch.wantValues(), watch.wantValues()];
    expect(server.asked).toEqual(["GET /runs/r/moments"]);
    server.first().answer(picture(3));
    await settle();
    clock.pass(10_000);
    expect(server.asked).toHaveLength(1);
    server.setStatus(now("live", 4));
    clock.pass(1_000);
    expect(server.asked).toHaveLength(2);
    server.first().answer(picture(4));
    await settle();
    happen(server, 3);
    server.tell(3);
    clock.pass(10_000);
    expect(server.asked).toHaveLength(3);
    server.first().answer(picture(6));
    await settle();
    expect(seen(watch)).toBe(6);
    for (const stop of stops) stop();
    for (const stop of stops) stop();
    expect(seen(watch)).toBe(null);
    happen(server, 3);
    server.tell(3);
    clock.pass(10_000);
    expect(server.asked).toHaveLength(3);
  });

  it("asks for nothing once the watch is closed", async () => {
    const { server, clock, watch } = setUp();
    watch.wantValues();
    server.first().answer(picture(0));
    await settle();
    watch.close();
    happen(server, 1);
    server.tell(1);
    clock.pass(60_000);
    expect([seen(watch), server.asked.length]).toEqual([0, 1]);
  });
});
