/** Mission control says what is: a run that waits, one that crashed, and one that is not heard. */

import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";
import {
  endRun,
  missionFolder,
  missionOf,
  openMission,
  startRun,
  status,
} from "./support/mission.ts";
import { runnersOf, whileStopped } from "./support/runner.ts";

const FAILS = {
  id: "LOADIN",
  name: "Load the box",
  script: ['raise RuntimeError("no box here")'],
};
const ASKS = {
  id: "WEIGHT",
  name: "Weigh the box",
  script: ["from rafcon import dialog", 'dialog.ask("Is the box closed?", ["yes", "no"])'],
};
const DRIVE = { id: "DRIVEE", name: "Drive to the bay", script: ["self.preemptive_wait(600)"] };
const MACHINES = {
  asks: missionFolder("asks", [FAILS, ASKS, DRIVE]),
  drives: missionFolder("drives", [DRIVE]),
};

/** Taken only where somebody wants to look. */
async function picture(app: App, name: string): Promise<void> {
  const folder = process.env["RAFCON_LOOK"];
  if (!folder) return;
  for (const colorScheme of ["dark", "light"] as const) {
    await app.sheet.emulateMedia({ colorScheme });
    for (const [width, height] of [
      [1280, 720],
      [1024, 768],
      [1920, 1080],
    ] as const) {
      await app.sheet.setViewportSize({ width, height });
      await app.drawn();
      await app.sheet.waitForTimeout(400);
      await app.sheet.screenshot({ path: `${folder}/${name}-${width}-${colorScheme}.png` });
    }
  }
}

journey(
  "a run whose only branch asks waits, in large, in lists and in the title, after a failure too",
  { machines: MACHINES, open: "asks" },
  async ({ app, server }) => {
    const run = await startRun(server, "asks");
    await openMission(app, "asks");
    await status(app).getByText("waiting").waitFor();
    await missionOf(app).getByText("an answer", { exact: false }).first().waitFor();
    await app.until(
      ({ page }, id) => page.runs.all.value.find((each) => each.id === id)?.waits === "answer",
      run,
    );
    await picture(app, "waits");
    await app.sheet.keyboard.press("Shift+F7");
    const asked = app.sheet.getByRole("dialog", { name: "Start another run?" });
    await asked.getByText(/A run of “asks” is active/).waitFor();
    await asked.getByRole("button", { name: "Cancel" }).click();
    await endRun(server, run);
  },
);

journey(
  "a run that crashed waits for a decision, and one that is not heard is grey in the time line too",
  { machines: MACHINES, open: "drives" },
  async ({ app, server }) => {
    const run = await startRun(server, "drives");
    await openMission(app, "drives");
    await missionOf(app).getByText("Nothing to decide").waitFor();
    const grey = app.sheet.locator(".timeline.is-old");
    await whileStopped(server, run, async () => {
      await grey.waitFor();
      await picture(app, "silent");
    });
    await grey.waitFor({ state: "detached" });
    for (const pid of runnersOf(server, run)) process.kill(pid, "SIGKILL");
    await missionOf(app).getByRole("button", { name: "1 decision" }).waitFor();
    await picture(app, "crashed");
  },
);
