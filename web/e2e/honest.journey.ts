/** The page says what it does not know, and afterwards knows all of it. How long the network is cut may be said by
 * `RAFCON_CUT_MS`. */

import { expect } from "vitest";
import {
  endsWhole,
  goesOn,
  linkIs,
  looksAlive,
  PACKER,
  startAndShow,
  statusIs,
  untilDownFor,
} from "./support/honest.ts";
import { journey } from "./support/journey.ts";
import { endRun, eventually, missionOf, status } from "./support/mission.ts";
import { whileStopped } from "./support/runner.ts";
import { Wire } from "./support/wire.ts";

const HERE = { machines: { packer: PACKER }, open: "packer" };
const FOREVER = { inputs: { wanted: 1_000_000 } };
const CUT_MS = Number(process.env["RAFCON_CUT_MS"] ?? 0);

journey(
  "the server is killed and begins again in the middle of a run: the page has every event once",
  HERE,
  async ({ app, server }) => {
    const run = await startAndShow(app, server, "packer", FOREVER);
    await goesOn(app);
    await server.end("SIGKILL");
    await linkIs(app, "down");
    await server.restart();
    await linkIs(app, "up");
    await goesOn(app);
    await endsWhole(app, server, run);
  },
);

journey(
  "the network is cut in the middle of a run: what is shown is greyed with its age, and then the page has every event once",
  HERE,
  async ({ app, server }) => {
    const wire = await Wire.to(server);
    try {
      await app.sheet.goto(wire.link);
      await app.connected();
      await app.open("packer");
      const run = await startAndShow(app, server, "packer", FOREVER);
      await goesOn(app);
      const old = app.sheet.locator(".canvas-mount.is-old");
      await old.waitFor({ state: "detached" });
      wire.cut("silent");
      await old.waitFor();
      await app.showsText(/No answer from the server for \d+ s|^No connection for/);
      await linkIs(app, "down");
      await app.sheet.getByText(/^No connection for/).waitFor();
      await untilDownFor(app, CUT_MS);
      wire.mend();
      await linkIs(app, "up");
      await old.waitFor({ state: "detached" });
      await goesOn(app);
      await endsWhole(app, server, run);
    } finally {
      wire.close();
    }
  },
);

journey(
  "a command that is given while the network is cut is under way, and says that it expired",
  HERE,
  async ({ app, server }) => {
    const wire = await Wire.to(server);
    try {
      await app.sheet.goto(wire.link);
      await app.connected();
      await app.open("packer");
      const run = await startAndShow(app, server, "packer", FOREVER);
      await statusIs(app, "running");
      wire.cut("refusing");
      await linkIs(app, "down");
      await app.sheet.evaluate(() => {
        const watch = window.__rafcon.page.active.value?.run.value;
        void watch?.command({ type: "pause" }, 500);
      });
      const commands = app.sheet.getByRole("list", { name: "Pending commands" });
      await commands.getByText(/Pause sent \d+\.\d s ago, expired without an answer/).waitFor();
      wire.mend();
      await commands.getByText("Pause expired and was not carried out").waitFor();
      await statusIs(app, "running");
      await commands.getByRole("button", { name: "Close" }).click();
      await commands.getByText("expired").waitFor({ state: "detached" });
      await endRun(server, run);
    } finally {
      wire.close();
    }
  },
);

journey(
  "a command is under way until the robot has answered, and only then the page says that it paused",
  HERE,
  async ({ app, server }) => {
    const run = await startAndShow(app, server, "packer", FOREVER);
    await statusIs(app, "running");
    server.freeze();
    await app.sheet.evaluate(() => {
      void window.__rafcon.page.active.value?.run.value?.command({ type: "pause" }, 600_000);
    });
    const commands = app.sheet.getByRole("list", { name: "Pending commands" });
    await commands.getByText(/Pause sent \d+\.\d s ago, not answered yet/).waitFor();
    await statusIs(app, "running");
    server.thaw();
    await commands.getByText("Pause was carried out").waitFor();
    await statusIs(app, "paused");
    await endRun(server, run);
  },
);

journey(
  "a runner that hangs is told from one that has nothing to say: all is grey and says how old it is, until it answers",
  HERE,
  async ({ app, server }) => {
    const run = await startAndShow(app, server, "packer", FOREVER);
    await goesOn(app);
    await app.sheet.keyboard.press("Control+Alt+m");
    await status(app).waitFor();
    const live = missionOf(app).getByText("Live: server and robot respond");
    await live.waitFor();
    const old = app.sheet.locator(".canvas-mount.is-old");
    await old.waitFor({ state: "detached" });
    await whileStopped(server, run, async () => {
      await old.waitFor();
      const bar = missionOf(app).getByText(
        /^The server gets no answer from the robot: what you see is /,
      );
      await bar.waitFor();
      const before = await bar.textContent();
      await eventually(async () => (await bar.textContent()) !== before);
    });
    await old.waitFor({ state: "detached" });
    await live.waitFor();
    await goesOn(app);
    await endsWhole(app, server, run);
  },
);

journey(
  "while the robot is not heard nothing looks alive, in mission control and in the editor: no button and no sign",
  HERE,
  async ({ app, server }) => {
    const run = await startAndShow(app, server, "packer", FOREVER);
    await goesOn(app);
    const lay = (name: string) =>
      app.sheet.evaluate((layout) => window.__rafcon.context().shell.layouts.apply(layout), name);
    await lay("Debug");
    await app.panel("Running");
    await eventually(async () => (await looksAlive(app)).length > 0);
    await whileStopped(server, run, async () => {
      await app.sheet.locator(".canvas-mount.is-old").waitFor();
      for (const panel of ["Timeline", "Run history", "Statistics", "Watches", "Runs"]) {
        await app.panel(panel);
        expect(await looksAlive(app)).toEqual([]);
      }
      await lay("Mission control");
      await status(app).waitFor();
      expect(await looksAlive(app)).toEqual([]);
    });
    await endsWhole(app, server, run);
  },
);
