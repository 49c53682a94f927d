/** The page over a network that is slow, or silent for a while: it connects, says how old things are, and asks for nothing again. */

import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { endsWhole, goesOn, linkIs, PACKER, startAndShow } from "./support/honest.ts";
import { type Hands, journey } from "./support/journey.ts";
import { Wire } from "./support/wire.ts";

const HERE = { machines: { packer: PACKER }, open: "packer" };
const FOREVER = { inputs: { wanted: 1_000_000 } };

/** Shows a run over a network that can be made slow. */
async function over(
  { app, server }: Hands,
  go: (wire: Wire, run: string) => Promise<void>,
): Promise<void> {
  const wire = await Wire.to(server);
  try {
    await app.sheet.goto(wire.link);
    await app.connected();
    await app.open("packer");
    const run = await startAndShow(app, server, "packer", FOREVER);
    await goesOn(app);
    await go(wire, run);
  } finally {
    wire.close();
  }
}

/** Writes down each state of the connection from now on, and each time that what is shown becomes old. */
async function listen(app: App): Promise<() => Promise<readonly string[]>> {
  await app.sheet.evaluate(() => {
    const seen: string[] = [];
    Object.assign(window, { seen });
    window.__rafcon.page.server.link.subscribe(({ state }) => seen.push(state));
    const canvas = document.querySelector(".canvas-mount");
    const look = () => canvas?.classList.contains("is-old") && seen.push("old");
    if (canvas) new MutationObserver(look).observe(canvas, { attributeFilter: ["class"] });
  });
  return () => app.sheet.evaluate(() => Reflect.get(window, "seen") as string[]);
}

/** What the page knows of the connection. */
async function pulse(app: App) {
  const found = await app.sheet.evaluate(() => {
    const { link, pulse } = window.__rafcon.page.server;
    const connection = link.value.state === "up" ? link.value.connection : 0;
    const { ahead_ms = 0, delay_ms = 0 } = pulse.value ?? {};
    return { connection, ahead_ms, delay_ms: delay_ms ?? 0 };
  });
  return found;
}

const untilFresh = (app: App) =>
  app.sheet.locator(".canvas-mount.is-old").waitFor({ state: "detached" });

journey(
  "at 2 s each way the page connects, knows the delay and the server's clock, and does not flap",
  HERE,
  async (hands) => {
    const { app, server } = hands;
    await over(hands, async (wire, run) => {
      wire.slow({ oneWay_ms: 2_000, handshakes: 2 });
      wire.reset();
      await linkIs(app, "down");
      await linkIs(app, "up");
      await untilFresh(app);
      await app.until(({ page }) => (page.server.pulse.value?.delay_ms ?? 0) >= 4_000, null);
      const seen = await listen(app);
      await goesOn(app, 150);
      expect(await seen()).toEqual(["up"]);
      // Browser and server have the same clock here. A busy computer adds at most half of its delay as an error.
      const { ahead_ms, delay_ms } = await pulse(app);
      expect(delay_ms).toBeGreaterThanOrEqual(4_000);
      expect(Math.abs(ahead_ms)).toBeLessThanOrEqual(1 + (delay_ms - 4_000) / 2);
      wire.slow({});
      await endsWhole(app, server, run);
    });
  },
);

journey(
  "after a silence the connection continues where it was, and old news is not taken for new",
  HERE,
  async (hands) => {
    const { app, server } = hands;
    await over(hands, async (wire, run) => {
      wire.slow({ oneWay_ms: 500, handshakes: 2 });
      await app.until(({ page }) => (page.server.pulse.value?.delay_ms ?? 0) >= 1_000, null);
      const { connection } = await pulse(app);
      wire.cut("silent");
      await linkIs(app, "down");
      await app.sheet.getByText(/^No connection for/).waitFor();
      wire.mend();
      await linkIs(app, "up");
      await untilFresh(app);
      expect((await pulse(app)).connection).toBe(connection);
      await goesOn(app);
      wire.slow({});
      await endsWhole(app, server, run);
    });
  },
);

journey(
  "at 64 kbit/s what was missed is loaded over one connection, after how the run stands",
  HERE,
  async (hands) => {
    const { app, server } = hands;
    await over(hands, async (wire, run) => {
      wire.cut("refusing");
      await linkIs(app, "down");
      const { sequence } = await lastEvent(hands, run, 600);
      wire.slow({ bytesPerSecond: 8_000, oneWay_ms: 100, handshakes: 1 });
      wire.mend();
      const asked = listenToRequests(app);
      const seen = await listen(app);
      await linkIs(app, "up");
      await app.until(({ tab }) => tab?.run.value?.isCurrent.value === true, null);
      const isCaughtUp = await app.sheet.evaluate(
        () => window.__rafcon.page.active.value?.run.value?.isCaughtUp.value,
      );
      expect(isCaughtUp).toBe(false);
      const { connection } = await pulse(app);
      await app.until(({ tab }, last) => (tab?.run.value?.journal.length ?? 0) >= last, sequence);
      await untilFresh(app);
      expect((await pulse(app)).connection).toBe(connection);
      expect((await seen()).filter((state) => state !== "old")).toEqual(["down", "up"]);
      const again = /^\/(projects|libraries|machines)/;
      expect(asked().filter((path) => again.test(path))).toEqual([]);
      wire.slow({});
      await endsWhole(app, server, run);
    });
  },
);

/** Waits until the run has had so many events more than now. */
async function lastEvent({ server }: Hands, run: string, more: number) {
  const look = async () => {
    const { snapshot } = await server.ask<{ snapshot: { sequence: number } }>(
      "GET",
      `/runs/${run}`,
    );
    return snapshot;
  };
  const before = await look();
  let now = before;
  while (now.sequence < before.sequence + more) now = await look();
  return now;
}

/** What the page asks for by requests from now on. */
function listenToRequests({ sheet }: App): () => readonly string[] {
  const asked = new Set<string>();
  sheet.on("request", (request) => {
    const path = new URL(request.url()).pathname.replace("/api/v1", "");
    if (request.resourceType() === "fetch" && path !== "/session") asked.add(path);
  });
  return () => [...asked].sort();
}
