/** A browser that translates the page: nothing old is shown as if it were true. */

import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";
import {
  endRun,
  missionFolder,
  openMission,
  startRun,
  status,
  untilOver,
} from "./support/mission.ts";

const DRIVE = { id: "DRIVEE", name: "Drive to the bay", script: ["self.preemptive_wait(600)"] };
const HERE = { machines: { drives: missionFolder("drives", [DRIVE]) }, open: "drives" };

/** Translates as browsers do, again and again: `<font>` elements replace the texts. */
async function translate(app: App, isObedient: boolean): Promise<void> {
  await app.sheet.evaluate((obeys) => {
    const all = () => {
      const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
      const texts: Text[] = [];
      while (walker.nextNode()) texts.push(walker.currentNode as Text);
      for (const text of texts) {
        const around = text.parentElement;
        if (!around || around.closest("font, script, style") || text.data.trim() === "") continue;
        if (obeys && around.closest("[translate=no], .notranslate")) continue;
        const font = document.createElement("font");
        font.append(document.createElement("font"));
        font.firstElementChild?.append(`${text.data} (übersetzt)`);
        text.replaceWith(font);
      }
    };
    all();
    setInterval(all, 100);
  }, isObedient);
}

journey("browsers are asked not to translate the page", HERE, async ({ app }) => {
  await translate(app, true);
  expect(await app.sheet.locator("font").count()).toBe(0);
});

journey(
  "mission control tells the truth under a translator that translates all the same",
  HERE,
  async ({ app, server }) => {
    const run = await startRun(server, "drives");
    await openMission(app, "drives");
    await status(app).getByText("Running", { exact: false }).waitFor();
    await translate(app, false);
    await app.showsText("A translator changes the texts of this page");
    const pause = { id: `pause-${run}`, command: { type: "pause" } };
    await server.ask("POST", `/runs/${run}/commands`, pause);
    await status(app).getByText("Paused", { exact: false }).waitFor();
    await endRun(server, run);
    await untilOver(app);
    expect(await status(app).textContent()).not.toMatch(/running|paused/i);
  },
);
