import { describe, expect, it } from "vitest";
import type { ToClient, ToServer } from "../model/generated/protocol.ts";
import { FakeClock } from "./fake_clock.ts";
import { Socket, type WireNews } from "./socket.ts";

type Verdict = "welcome" | "stranger" | "silent";

function setUp(verdict: Verdict = "welcome") {
  const clock = new FakeClock();
  const wires: { news: WireNews; said: ToServer[]; isOpen: boolean }[] = [];
  const posts: { frame: ToServer; done: (revision: number) => void }[] = [];
  const socket = new Socket({
    clock,
    random: () => 0.5,
    probe: () => Promise.resolve(verdict),
    post: (frame) => new Promise((done) => posts.push({ frame, done })),
    dial: (news) => {
      const wire = { news, said: [] as ToServer[], isOpen: true };
      wires.push(wire);
      return {
        send: (text) => wire.said.push(JSON.parse(text) as ToServer),
        close: () => {
          wire.isOpen = false;
        },
      };
    },
  });
  const wire = () => {
    const last = wires.at(-1);
    if (!last) throw new Error("nobody has dialled");
    return last;
  };
  const hear = (frame: ToClient) => wire().news.text(JSON.stringify(frame));
  const welcome = () =>
    hear({
      frame: "welcome",
      protocol: 1,
      session: { user: "anna", role: "engineer", rights: [], version: "0", expires_ms: null },
      connection: 7,
      now_ms: clock.now() + 40,
    });
  const said = () =>
    wire()
      .said.filter(({ frame }) => frame !== "ping")
      .map((frame) =>
        "subscription" in frame ? `${frame.frame} ${frame.subscription}` : frame.frame,
      );
  return { clock, socket, wires, posts, wire, hear, welcome, said };
}

const SILENT = { topic: () => ({ topic: "house_status" }) as const, frame: () => {} };
const UNDO: ToServer = { frame: "undo", machine: "m", undo: { id: "1" } };

async function settle(): Promise<void> {
  for (let turn = 0; turn < 10; turn += 1) await Promise.resolve();
}

describe("the socket", () => {
  it("subscribes when it is up, and again from the cursor after a break", () => {
    const { clock, socket, wire, hear, welcome } = setUp();
    let from = 1;
    socket.follow({
      topic: () => ({ topic: "machine_history", machine: "m", from }),
      frame: () => {
        from = 5;
      },
    });
    expect(wire().said).toEqual([]);
    welcome();
    hear({ frame: "revisions", subscription: 1, revisions: [] });
    wire().news.closed("gone");
    expect(socket.link.value).toMatchObject({ state: "down", reason: "gone" });
    clock.pass(0);
    welcome();
    const topics = wire().said.flatMap((frame) => (frame.frame === "subscribe" ? frame.topic : []));
    expect(topics).toEqual([{ topic: "machine_history", machine: "m", from: 5 }]);
  });

  it("says an edit again after a break until it is answered, and never after that", async () => {
    const { clock, socket, wire, hear, welcome, said } = setUp();
    welcome();
    const answer = socket.ask("1", UNDO);
    expect(said()).toEqual(["undo"]);
    wire().news.closed("gone");
    clock.pass(0);
    welcome();
    expect(said()).toEqual(["undo"]);
    hear({ frame: "edited", id: "1", revision: 9 });
    expect(await answer).toBe(9);
    wire().news.closed("gone");
    clock.pass(0);
    welcome();
    expect(said()).toEqual([]);
  });

  it("tells why something was refused, but not that the server ends", async () => {
    const { socket, hear, welcome, wire, clock } = setUp();
    welcome();
    const answer = socket.ask("1", UNDO);
    hear({ frame: "refused", id: "1", refusal: { code: "server_ends", message: "it ends" } });
    wire().news.closed("server_ends");
    clock.pass(0);
    welcome();
    hear({ frame: "refused", id: "1", refusal: { code: "no_step", message: "nothing to undo" } });
    await expect(answer).rejects.toThrow("nothing to undo");
  });

  it("sends what is too large alone, after what was before and before what comes after", async () => {
    const { socket, hear, welcome, said, posts } = setUp();
    welcome();
    const name = "x".repeat(400_000);
    const edit = {
      id: "2",
      base: null,
      name: "Large",
      edit: { edit: "set_name", path: "R", name },
    } as const;
    void socket.ask("1", UNDO);
    const large = socket.ask("2", { frame: "edit", machine: "m", edit });
    void socket.ask("3", UNDO);
    expect([said(), posts.length]).toEqual([["undo"], 0]);
    hear({ frame: "edited", id: "1", revision: 1 });
    expect([said(), posts.length]).toEqual([["undo"], 1]);
    posts[0]?.done(2);
    expect(await large).toBe(2);
    expect(said()).toEqual(["undo", "undo"]);
  });

  it("follows until it is told to stop, or until nothing more comes", () => {
    const { socket, hear, welcome, said } = setUp();
    const heard: string[] = [];
    const follower = { topic: SILENT.topic, frame: ({ frame }: ToClient) => heard.push(frame) };
    const stop = socket.follow(follower);
    socket.follow(follower);
    welcome();
    stop();
    expect(said()).toEqual(["subscribe 1", "subscribe 2", "unsubscribe 1"]);
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

  it("stops dialling where it is not let in, until somebody logs in", async () => {
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

  it("takes a silent connection for dead, and knows how long a question takes", () => {
    const { clock, socket, wires, hear, welcome } = setUp();
    welcome();
    clock.pass(30);
    hear({ frame: "pong", id: 1, now_ms: clock.now() + 20 });
    expect(socket.pulse.value).toEqual({ heard_ms: clock.now(), delay_ms: 30, ahead_ms: 35 });
    clock.pass(5_000);
    expect(wires).toHaveLength(1);
    const heard_ms = clock.now() - 5_000;
    clock.pass(13_000);
    expect(socket.link.value).toMatchObject({ state: "down", since_ms: heard_ms });
    clock.pass(7_000);
    expect(wires.length).toBeGreaterThan(1);
    expect(wires[0]?.isOpen).toBe(false);
  });
});
