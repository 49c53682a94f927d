/** Two tabs of one browser, and two runs in one page: what is said in one counts in the other, and what is told to one run does not. */

import { expect, vi } from "vitest";
import type { RunNow } from "../src/model/generated/protocol.ts";
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
import { PATIENCE } from "./support/patience.ts";
import { heldBefore, press, stopRun } from "./support/runs.ts";

const PART = "PACKER/ONEPAR";

/** A state as screen readers are told it. */
function heard(app: App, name: RegExp) {
  return app.canvas.getByRole("treeitem", { name });
}

journey(
  "breakpoints for the next start are the same in two tabs of a browser",
  { open: "hierarchy_and_data" },
  async ({ app, tab }) => {
    const other = await tab(app);
    await other.open("hierarchy_and_data");
    await app.select(PART);
    await app.press("Control+F9");
    await heard(app, /^Pack one part, breakpoint, hierarchy/).waitFor();
    await other.select(PART);
    await heard(other, /^Pack one part, breakpoint, hierarchy/).waitFor();
    await other.panel("Breakpoints");
    await other.sheet.getByRole("checkbox", { name: "Breakpoint 1 is on" }).uncheck();
    await heard(app, /^Pack one part, breakpoint off, hierarchy/).waitFor();
    await other.sheet.getByRole("checkbox", { name: "Breakpoint 1 is on" }).check();
    await heard(app, /^Pack one part, breakpoint, hierarchy/).waitFor();
    await press(app, "Start");
    await heldBefore(app, PART);
    await heard(app, /^Pack one part, comes next, breakpoint, hierarchy/).waitFor();
    await app.canvas.getByRole("status").getByText("Pack one part comes next").waitFor();
    await stopRun(app);
    await other.sheet.getByRole("button", { name: "Remove breakpoint 1" }).click();
    await heard(app, /^Pack one part, [^b]*hierarchy/).waitFor();
  },
);

const FAILS = { id: "GRASPS", name: "Grasp", script: ['raise RuntimeError("no box here")'] };
const DRIVE = { id: "DRIVEE", name: "Drive to the bay", script: ["self.preemptive_wait(3600)"] };
const LOAD = { id: "LOADIN", name: "Load the box", script: ["self.preemptive_wait(3600)"] };

journey(
  "what was acknowledged in one tab of a browser is acknowledged in the other",
  { machines: { fails: missionFolder("fails", [FAILS, DRIVE]) }, open: "fails" },
  async ({ app, server, tab }) => {
    const run = await startRun(server, "fails");
    const other = await tab(app);
    await openMission(app, "fails");
    await openMission(other, "fails");
    const events = (of: App) =>
      missionOf(of).getByRole("region", { name: "Events to acknowledge" });
    for (const one of [app, other]) await events(one).getByText("To acknowledge: 1").waitFor();
    await events(app).getByRole("button", { name: "Acknowledge", exact: true }).click();
    for (const one of [app, other]) await events(one).getByText("Nothing to acknowledge").waitFor();
    await endRun(server, run);
  },
);

journey(
  "of two runs in progress at once, mission control holds the one that it shows",
  { machines: { drives: missionFolder("drives", [DRIVE]), loads: missionFolder("loads", [LOAD]) } },
  async ({ app, server }) => {
    const [drives, loads] = [await startRun(server, "drives"), await startRun(server, "loads")];
    const statusOf = async (run: string) =>
      (await server.ask<RunNow>("GET", `/runs/${run}`)).snapshot?.status;
    await openMission(app, "drives");
    const mission = missionOf(app);
    const others = mission.getByLabel("Other active runs");
    const branch = (name: string) => mission.getByRole("button", { name });
    await branch("Drive to the bay").waitFor();
    await others.selectOption(loads);
    await branch("Load the box").waitFor();
    await branch("Drive to the bay").waitFor({ state: "detached" });
    await mission.getByRole("button", { name: "Pause", exact: true }).focus();
    await vi.waitUntil(async () => {
      await app.sheet.keyboard.press("Enter");
      return (await statusOf(loads)) === "paused";
    }, PATIENCE);
    await status(app).getByText("paused").waitFor();
    expect(await statusOf(drives)).toBe("running");
    await others.selectOption(drives);
    await branch("Drive to the bay").waitFor();
    await mission.getByText("Running").waitFor();
    for (const run of [drives, loads]) await endRun(server, run);
  },
);
