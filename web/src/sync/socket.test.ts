import { describe, expect, it } from "vitest";
import { FRAMES_VERSION, type ToClient, type ToServer } from "../model/generated/protocol.ts";
import type { AnswerFrame, Server } from "../store/page/server.ts";
import { Delay } from "./delay.ts";
import { type EditOnItsWay, EditOutbox } from "./edit_outbox.ts";
import { Socket, type Verdict, type WireNews } from "./socket.ts";
import { FakeClock } from "./testing/fake_clock.ts";

function setUp(verdict: Verdict | "never" = "welcome") {
  const clock = new FakeClock();
  const wires: { news: WireNews; sent: ToServer[]; isOpen: boolean }[] = [];
  const posts: { path: string; done: (answer: { revision: number }) => void }[] = [];
  const socket = new Socket({
    clock,
    delay: new Delay(),
    random: () => 0.5,
    probe: () => (verdict === "never" ? new Promise(() => {}) : Promise.resolve(verdict)),
    dial: (news) => {
      const wire = { news, sent: [] as ToServer[], isOpen: true };
      wires.push(wire);
      return {
        send: (text) => wire.sent.push(JSON.parse(text) as ToServer),
        close: () => {
          wire.isOpen = false;
        },
      };
    },
  });
  const request = (_: string, path: string) => new Promise((done) => posts.push({ path, done }));
  const edits = new EditOutbox({
    server: {
      link: socket.link,
      say: (frame: ToServer) => socket.say(frame),
      onAnswer: (listener: (frame: AnswerFrame) => void) => socket.onAnswer(listener),
      request,
    } as unknown as Server,
    clock,
    machine: () => "m",
    onAnswer: (revision) => edits.arrived(revision, null),
    onRefusal: ({ id }, { message }) => edits.refuse(id, message),
  });
  const ask = (id: string, frame: ReturnType<EditOnItsWay["frame"]>) => {
    const edit = frame.frame === "edit" ? frame.edit.edit : null;
    return edits.put({ id, name: "", since_ms: 0, edit, frame: () => frame });
  };
  const wire = () => {
    const last = wires.at(-1);
    if (!last) throw new Error("nobody has dialled");
    return last;
  };
  const hear = (frame: ToClient) => wire().news.text(JSON.stringify(frame));
  const welcome = (protocol = FRAMES_VERSION) =>
    hear({
      frame: "welcome",
      protocol,
      session: { user: "anna", role: "engineer", rights: [], version: "0", expires_ms: null },
      connection: 7,
      now_ms: clock.now() + 40,
    });
  const sentFrames = () =>
    wire()
      .sent.filter(({ frame }) => frame !== "ping")
      .map((frame) =>
        "subscription" in frame ? `${frame.frame} ${frame.subscription}` : frame.frame,
      );
  return { clock, socket, ask, wires, posts, wire, hear, welcome, sentFrames };
}

const SILENT = { topic: () => ({ topic: "server_status" }) as const, frame: () => {} };
const UNDO = { frame: "undo", machine: "m", undo: { id: "1" } } as const;

async function settle(): Promise<void> {
  for (let turn = 0; turn < 10; turn += 1) await Promise.resolve();
}

describe("the socket", () => {
  it("says that the page has to be loaded again where the server is of another version", () => {
    const { socket, welcome } = setUp();
    welcome(FRAMES_VERSION + 1);
    expect(socket.link.peek()).toEqual({
      state: "refused",
      reason: "the server and this page have different versions: reload the page",
    });
  });

  it("subscribes when it is up, and again from the cursor after a break", () => {
    const { clock, socket, wire, hear, welcome } = setUp();
    let from = 1;
    socket.follow({
      topic: () => ({ topic: "machine_history", machine: "m", from }),
      frame: () => {
        from = 5;
      },
    });
    expect(wire().sent).toEqual([]);
    welcome();
    hear({ frame: "revisions", subscription: 1, revisions: [] });
    wire().news.closed("gone");
    expect(socket.link.value).toMatchObject({ state: "down", reason: "gone" });
    clock.pass(0);
    welcome();
    const topics = wire().sent.flatMap((frame) => (frame.frame === "subscribe" ? frame.topic : []));
    expect(topics).toEqual([{ topic: "machine_history", machine: "m", from: 5 }]);
  });

  it.each([
    ["300,000 characters goes over the socket", 300_000, ["edit"], 0],
    ["300,001 characters goes by HTTP", 300_001, [], 1],
  ])("an edit of %s", async (_, length, expected, posted) => {
    const { ask, welcome, sentFrames, posts } = setUp();
    welcome();
    const edit = { edit: "set_name", path: "R", name: "" } as const;
    const name = "x".repeat(length - JSON.stringify(edit).length);
    const large = { id: "1", base: 1, name: "", edit: { ...edit, name } };
    void ask("1", { frame: "edit", machine: "m", edit: large });
    await settle();
    expect([sentFrames(), posts.length]).toEqual([expected, posted]);
  });

  it("says an edit again after a break until it is answered, and never after that", async () => {
    const { clock, ask, wire, hear, welcome, sentFrames } = setUp();
    welcome();
    const answer = ask("1", UNDO);
    expect(sentFrames()).toEqual(["undo"]);
    wire().news.closed("gone");
    clock.pass(0);
    welcome();
    expect(sentFrames()).toEqual(["undo"]);
    hear({ frame: "edited", id: "1", revision: 9 });
    expect(await answer).toEqual({ revision: 9 });
    wire().news.closed("gone");
    clock.pass(0);
    welcome();
    expect(sentFrames()).toEqual([]);
  });

  it("tells why something was refused, but not that the server ends", async () => {
    const { ask, hear, welcome, wire, clock } = setUp();
    welcome();
    const answer = ask("1", UNDO);
    hear({ frame: "refused", id: "1", refusal: { code: "server_ends", message: "it ends" } });
    wire().news.closed("server_ends");
    clock.pass(0);
    welcome();
    hear({ frame: "refused", id: "1", refusal: { code: "no_step", message: "nothing to undo" } });
    expect(await answer).toEqual({ refused: "nothing to undo" });
  });

  it("sends what is too large alone, after what was before and before what comes after", async () => {
    const { ask, hear, welcome, sentFrames, posts } = setUp();
    welcome();
    const name = "x".repeat(400_000);
    const edit = {
      id: "2",
      base: null,
      name: "Large",
      edit: { edit: "set_name", path: "R", name },
    } as const;
    void ask("1", UNDO);
    const large = ask("2", { frame: "edit", machine: "m", edit });
    void ask("3", UNDO);
    expect([sentFrames(), posts.length]).toEqual([["undo"], 0]);
    hear({ frame: "edited", id: "1", revision: 1 });
    expect([sentFrames(), posts.length]).toEqual([["undo"], 1]);
    expect(posts[0]?.path).toBe("/machines/m/edits");
    posts[0]?.done({ revision: 2 });
    expect(await large).toEqual({ revision: 2 });
    expect(sentFrames()).toEqual(["undo", "undo"]);
  });

  it("follows until it is told to stop, or until nothing more comes", () => {
    const { socket, hear, welcome, sentFrames } = setUp();
    const heard: string[] = [];
    const follower = { topic: SILENT.topic, frame: ({ frame }: ToClient) => heard.push(frame) };
    const stop = socket.follow(follower);
    socket.follow(follower);
    welcome();
    stop();
    expect(sentFrames()).toEqual(["subscribe 1", "subscribe 2", "unsubscribe 1"]);
    hear({ frame: "ended", subscription: 1, refusal: null });
    hear({ frame: "ended", subscription: 2, refusal: null });
    hear({ frame: "ended", subscription: 2, refusal: null });
    expect(heard).toEqual(["ended"]);
  });

  it("waits longer from try to try, and at once when the browser is back", async () => {
    const { clock, socket, wires, wire } = setUp();
    const waits: (number | null)[] = [];
    for (let tries = 0; tries < 7; tries += 1) {
      wire().news.closed("refused");
      const link = socket.link.value;
      const wait = link.state === "down" ? (link.retry_ms ?? 0) - clock.now() : null;
      waits.push(wait);
      clock.pass(wait ?? 0);
      await settle();
    }
    expect(waits).toEqual([0, 250, 500, 1_000, 2_000, 2_000, 2_000]);
    wire().news.closed("refused");
    const before = wires.length;
    socket.retry();
    expect(wires.length).toBe(before + 1);
  });

  it("stops dialling where it is not let in, until someone logs in", async () => {
    const { clock, socket, wires, wire, welcome } = setUp("stranger");
    wire().news.closed("refused");
    clock.pass(0);
    wire().news.closed("refused");
    clock.pass(250);
    await settle();
    expect(socket.link.value.state).toBe("refused");
    clock.pass(60_000);
    expect(wires).toHaveLength(2);
    socket.retry();
    welcome();
    expect(socket.link.value.state).toBe("up");
  });

  it("says that a connection is silent, and how long a question takes", () => {
    const { clock, socket, wires, hear, welcome } = setUp();
    welcome();
    clock.pass(30);
    hear({ frame: "pong", id: 1, now_ms: clock.now() + 20 });
    const heard_ms = clock.now();
    const times = { server_ms: heard_ms + 20, old_ms: 4_090 };
    expect(socket.pulse.value).toEqual({ heard_ms, delay_ms: 30, ahead_ms: 35, ...times });
    clock.pass(5_000);
    expect(wires).toHaveLength(1);
    clock.pass(13_000);
    expect(socket.link.value).toMatchObject({ state: "down", since_ms: heard_ms });
    expect(wires).toHaveLength(2);
    expect(wires[0]?.isOpen).toBe(true);
    welcome();
    expect([socket.link.value.state, wires[0]?.isOpen]).toEqual(["up", false]);
  });

  it("continues with a connection that was only silent, and asks for nothing again", () => {
    const { clock, socket, wires, welcome } = setUp();
    socket.follow(SILENT);
    const stop = socket.follow(SILENT);
    welcome();
    const [first] = wires;
    const pings = () =>
      first?.sent.flatMap((frame) => (frame.frame === "ping" ? frame.id : [])) ?? [];
    clock.pass(80_000);
    expect([socket.link.value.state, wires.length]).toEqual(["down", 4]);
    stop();
    socket.follow(SILENT);
    first?.news.text(
      JSON.stringify({ frame: "pong", id: pings()[0], now_ms: clock.now() - 59_000 }),
    );
    expect(socket.link.value).toMatchObject({ state: "up", connection: 7 });
    expect(wires.map(({ isOpen }) => isOpen)).toEqual([true, false, false, false]);
    const sent = first?.sent.filter(({ frame }) => frame !== "ping");
    expect(
      sent?.map((frame) => "subscription" in frame && `${frame.frame} ${frame.subscription}`),
    ).toEqual(["subscribe 1", "subscribe 2", "unsubscribe 2", "subscribe 3"]);
    clock.pass(4_000);
    expect(wires).toHaveLength(4);
  });

  it("names the address of the page where the server accepts another one only", async () => {
    const { clock, socket, wire } = setUp({ turnedAway: "this page was opened at https://a" });
    wire().news.closed("the connection was lost");
    clock.pass(0);
    wire().news.closed("the connection was lost");
    clock.pass(250);
    await settle();
    expect(socket.link.value).toEqual({
      state: "refused",
      reason: "this page was opened at https://a",
    });
  });

  it("does not wait for ever to be told whether it is let in", async () => {
    const { clock, socket, wires, wire } = setUp("never");
    wire().news.closed("refused");
    clock.pass(0);
    wire().news.closed("refused");
    clock.pass(250);
    await settle();
    expect(wires).toHaveLength(2);
    clock.pass(40_000);
    await settle();
    expect(socket.link.value).toMatchObject({
      state: "down",
      reason: "the server does not respond",
    });
  });
});

/** A network that takes its time: handshakes of so many rounds, each way so long, and the server's clock is 5 s ahead. */
function slowly(oneWay_ms: number, rounds: number, minutes: number): string {
  const clock = new FakeClock();
  let dials = 0;
  const socket = new Socket({
    clock,
    delay: new Delay(),
    random: () => 0.5,
    probe: () => Promise.resolve("welcome"),
    dial: (news) => {
      dials += 1;
      let isOpen = true;
      const later = (ms: number, frame: () => ToClient) =>
        clock.after(ms, () => {
          const text = JSON.stringify(frame());
          clock.after(oneWay_ms, () => isOpen && news.text(text));
        });
      later((2 * rounds - 1) * oneWay_ms, () => welcomeAt(clock.now() + 5_000));
      return {
        send: (text) => {
          const sent = JSON.parse(text) as ToServer;
          if (sent.frame !== "ping") return;
          later(oneWay_ms, () => ({ frame: "pong", id: sent.id, now_ms: clock.now() + 5_000 }));
        },
        close: () => {
          isOpen = false;
        },
      };
    },
  });
  const seen: string[] = [];
  let oldest_ms = 0;
  for (let second = 0; second < minutes * 60; second += 1) {
    clock.pass(1_000);
    const { state } = socket.link.value;
    if (seen.at(-1)?.endsWith(state) !== true) seen.push(`${second + 1} s: ${state}`);
    const pulse = socket.pulse.value;
    if (!pulse) continue;
    const age_ms = clock.now() + pulse.ahead_ms - pulse.server_ms;
    if (age_ms >= pulse.old_ms) seen.push(`${second + 1} s: old`);
    oldest_ms = Math.max(oldest_ms, age_ms);
  }
  const pulse = socket.pulse.value;
  seen.push(`round trip ${pulse?.delay_ms} ms, clock ahead ${pulse?.ahead_ms} ms, ${dials} dials`);
  return seen.join("\n");
}

function welcomeAt(now_ms: number): ToClient {
  const session = {
    user: "anna",
    role: "engineer",
    rights: [],
    version: "0",
    expires_ms: null,
  } as const;
  return {
    frame: "welcome",
    protocol: FRAMES_VERSION,
    session: { ...session, rights: [] },
    connection: 7,
    now_ms,
  };
}

describe("over a slow network", () => {
  it("connects by TLS at 2 s each way, measures it, and never flaps", () => {
    expect(slowly(2_000, 3, 5)).toMatchInlineSnapshot(`
      "1 s: connecting
      12 s: up
      round trip 4000 ms, clock ahead 5000 ms, 1 dials"
    `);
  });

  it("connects at 6 s each way, farther than anyone is", () => {
    expect(slowly(6_000, 3, 5)).toMatchInlineSnapshot(`
      "1 s: connecting
      30 s: down
      66 s: up
      round trip 12000 ms, clock ahead 5000 ms, 2 dials"
    `);
  });

  it("is as quick as it can be at 1 ms", () => {
    expect(slowly(1, 2, 1)).toMatchInlineSnapshot(`
      "1 s: up
      round trip 2 ms, clock ahead 5000 ms, 1 dials"
    `);
  });
});
