import { afterEach, describe, expect, it, vi } from "vitest";
import { REPEATED, RefusalError } from "../store/page/server.ts";
import { requests } from "./http.ts";
import { FakeClock } from "./testing/fake_clock.ts";

/** A network in which a test says what comes of each request. */
function setUp() {
  const clock = new FakeClock();
  const heard: string[] = [];
  const answers: {
    begin: (status: number) => void;
    piece: (text: string) => void;
    end: () => void;
  }[] = [];
  let alive = 0;
  vi.stubGlobal("fetch", (_: string, { signal }: RequestInit) => {
    let control: ReadableStreamDefaultController<Uint8Array>;
    const body = new ReadableStream<Uint8Array>({
      start: (made) => {
        control = made;
      },
    });
    return new Promise<Response>((answered, failed) => {
      signal?.addEventListener("abort", () => {
        failed(new Error("aborted"));
        control.error(new Error("aborted"));
      });
      answers.push({
        begin: (status) => answered(new Response(body, { status })),
        piece: (text) => control.enqueue(new TextEncoder().encode(text)),
        end: () => control.close(),
      });
    });
  });
  const all = requests(
    { url: "http://robot" },
    {
      clock,
      limit_ms: (isRepeated, bytes) => (isRepeated ? 1_000 : 9_000) + bytes,
      alive: () => {
        alive += 1;
      },
      onResponse: (method, path, status) => heard.push(`${method} ${path} ${status}`),
    },
  );
  return { ...all, clock, heard, answers, alive: () => alive };
}

async function settle(): Promise<void> {
  for (let turn = 0; turn < 20; turn += 1) await Promise.resolve();
}

/** What became of a request: a value, or why not. */
async function fate(asked: Promise<unknown>): Promise<unknown> {
  return asked.catch((error: unknown) =>
    error instanceof RefusalError ? `${error.status} ${error.code}` : error,
  );
}

afterEach(() => vi.unstubAllGlobals());

describe("a request", () => {
  it("is given up when nothing comes for too long, sooner if it is repeated", async () => {
    const { request, clock, heard } = setUp();
    const [once, repeated] = [request("GET", "/a"), request("POST", "/b", {}, REPEATED)].map(fate);
    clock.pass(1_002);
    expect(await repeated).toBe("0 no_answer");
    expect(heard).toEqual(["POST /b 0"]);
    clock.pass(7_998);
    expect(await once).toBe("0 no_answer");
  });

  it("continues for as long as something comes of it, which shows that the network is there", async () => {
    const { request, clock, answers, alive } = setUp();
    const asked = fate(request("GET", "/a", undefined, REPEATED));
    answers[0]?.begin(200);
    await settle();
    for (const piece of ['{"a"', ":", "1}"]) {
      clock.pass(900);
      answers[0]?.piece(piece);
      await settle();
    }
    answers[0]?.end();
    expect(await asked).toEqual({ a: 1 });
    expect(alive()).toBe(4);
  });

  it("has no answer if that breaks off in the middle", async () => {
    const { request, clock, answers } = setUp();
    const asked = fate(request("GET", "/a", undefined, REPEATED));
    answers[0]?.begin(200);
    answers[0]?.piece("[1,");
    await settle();
    clock.pass(1_000);
    expect(await asked).toBe("0 no_answer");
  });

  it("that is repeated is given up when the connection is back, and no other one", async () => {
    const { request, askAgain, answers } = setUp();
    const once = fate(request("GET", "/a"));
    const repeated = fate(request("GET", "/b", undefined, REPEATED));
    askAgain();
    expect(await repeated).toBe("0 no_answer");
    answers[0]?.begin(404);
    answers[0]?.piece('{"code":"no","message":"there is none"}');
    answers[0]?.end();
    expect(await once).toBe("404 no");
  });
});

describe("what comes line by line", () => {
  const asked = (control = new AbortController()) => {
    const network = setUp();
    const received: unknown[] = [];
    const done = network.lines("/plans", {}, (line) => received.push(line), control.signal);
    return { ...network, received, done, control };
  };

  it("is told at each line, wherever the pieces break", async () => {
    const { answers, received, done } = asked();
    answers[0]?.begin(200);
    answers[0]?.piece('{"a":1}\n{"b"');
    await settle();
    expect(received).toEqual([{ a: 1 }]);
    answers[0]?.piece(":2}\n3");
    answers[0]?.end();
    await done;
    expect(received).toEqual([{ a: 1 }, { b: 2 }, 3]);
  });

  it("ends without a word when it is not wanted any more", async () => {
    const { answers, received, done, control } = asked();
    answers[0]?.begin(200);
    answers[0]?.piece("1\n");
    await settle();
    control.abort();
    await done;
    expect(received).toEqual([1]);
  });

  it("is refused as other requests are", async () => {
    const busy = asked();
    busy.answers[0]?.begin(429);
    busy.answers[0]?.piece('{"code":"too_many_plans","message":"later"}');
    busy.answers[0]?.end();
    expect(await fate(busy.done)).toBe("429 too_many_plans");
    const unreadable = asked();
    unreadable.answers[0]?.begin(200);
    unreadable.answers[0]?.piece("<html>\n");
    expect(await fate(unreadable.done)).toBe("200 unreadable");
  });
});
