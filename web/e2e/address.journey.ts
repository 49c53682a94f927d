/** What the address of the page asks for: mission control, a run, both. */

import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { type Hands, journey } from "./support/journey.ts";
import { endRun, missionFolder, missionOf, startRun, status } from "./support/mission.ts";

const DRIVE = { id: "DRIVEE", name: "Drive to the bay", script: ["self.preemptive_wait(3600)"] };
const HERE = { machines: { drives: missionFolder("drives", [DRIVE]) } };

/** Comes by an address, and looks whether it asks no more once that was done. */
async function come(app: App, asked: string): Promise<void> {
  await app.sheet.goto(`${app.server.url}/${asked}`);
  await app.connected();
  await expect.poll(() => new URL(app.sheet.url()).search).toBe("");
}

async function showsRun(app: App, run: string): Promise<void> {
  await app.until(({ tab }, id) => tab?.run.value?.id === id, run);
}

async function during({ server }: Hands, go: (run: string) => Promise<void>): Promise<void> {
  const run = await startRun(server, "drives");
  try {
    await go(run);
  } finally {
    await endRun(server, run);
  }
}

journey("an address leads to mission control", HERE, async (hands) => {
  await during(hands, async () => {
    await come(hands.app, "?layout=mission");
    await missionOf(hands.app).getByText("Which mission?").waitFor();
  });
});

journey(
  "an address leads to a run in its machine, in the layout that one has",
  HERE,
  async (hands) => {
    const { app } = hands;
    await during(hands, async (run) => {
      await come(app, `?run=${run}`);
      await showsRun(app, run);
      await app.until(
        ({ tab, canvas }) => canvas !== null && tab?.session.machine.root === "MISSIO",
        null,
      );
      expect(await missionOf(app).count()).toBe(0);
    });
  },
);

journey(
  "an address leads to a run in mission control, and a reload stays there",
  HERE,
  async (hands) => {
    const { app } = hands;
    await during(hands, async (run) => {
      await come(app, `?layout=mission&run=${run}`);
      await showsRun(app, run);
      await status(app).getByText("running").waitFor();
      await app.sheet.reload();
      await app.connected();
      await showsRun(app, run);
      await status(app).getByText("running").waitFor();
    });
  },
);

journey("an address with a run that there is not says so", HERE, async ({ app }) => {
  await come(app, "?layout=mission&run=nobody-knows-it");
  await app.showsText(/nobody-knows-it/);
});

journey(
  "below the path of a proxy the page asks for nothing elsewhere",
  { ...HERE, serve: ["--base-path", "/robot"] },
  async ({ app, server }) => {
    const asked: string[] = [];
    // The page that the journey began with loads its last parts when it is idle.
    await app.sheet.goto("about:blank");
    app.sheet.on("request", (request) => asked.push(request.url()));
    app.sheet.on("websocket", (socket) => asked.push(socket.url()));
    await app.sheet.goto(`${server.url}/robot?token=${server.token}`);
    await app.connected();
    expect(app.sheet.url()).toBe(`${server.url}/robot/`);
    const paths = asked.filter((url) => /^(http|ws)/.test(url)).map((url) => new URL(url).pathname);
    expect(paths).toContain("/robot/api/v1/socket");
    expect(paths.filter((path) => path !== "/robot" && !path.startsWith("/robot/"))).toEqual([]);
  },
);
