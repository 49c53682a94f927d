/** The page of a station says what it knows of a robot's run, what it assumes, and what is not the robot's any more. */

import { expect } from "vitest";
import type { RobotMachines, RunSummary } from "../src/model/generated/protocol.ts";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";
import {
  endRun,
  eventually,
  missionFolder,
  missionOf,
  openMission,
  startRun,
  status,
} from "./support/mission.ts";
import { runnersOf } from "./support/runner.ts";
import { answer, press } from "./support/runs.ts";
import type { Server } from "./support/server.ts";
import { keepDisk } from "./support/station.ts";

const DRIVE = { id: "DRIVEE", name: "Drive to the bay", script: ["self.preemptive_wait(600)"] };
const HERE = { machines: { drives: missionFolder("drives", [DRIVE]) }, isStation: true };

/** Waits until the server has the run, like this. */
async function untilRun(
  server: Server,
  run: string,
  is: (summary: RunSummary) => boolean,
): Promise<void> {
  await eventually(async () => {
    const all = await server.ask<readonly RunSummary[]>("GET", "/runs");
    return all.some((one) => one.id === run && is(one));
  });
}

async function showRuns(app: App): Promise<void> {
  await app.sheet.evaluate(() => window.__rafcon.context().shell.showPanel("runs"));
}

async function tell(robot: Server, run: string, ...all: readonly string[]): Promise<void> {
  for (const type of all) {
    const id = `tell-${type}-${Date.now()}`;
    await robot.ask("POST", `/runs/${run}/commands`, { id, command: { type } });
  }
}

journey(
  "in a blackout lists say how old it is that a run goes on, and mission control tells its time by every clock",
  HERE,
  async ({ app, server, robot }) => {
    const run = await startRun(robot, "drives");
    await untilRun(server, run, ({ phase }) => phase === "live");
    await app.sheet.keyboard.press("Control+Alt+m");
    const missions = app.sheet.getByRole("list", { name: "Active runs" });
    await missions.getByText("running").waitFor();
    robot.freeze();
    await missions.locator(".is-old .mission-assumed").waitFor();
    await missions.getByText(/^as of .* ago$/).waitFor();
    robot.thaw();
    await missions.locator(".mission-assumed").waitFor({ state: "detached" });
    await openMission(app, "drives");
    const head = missionOf(app).locator(".mission-head");
    await head.getByText(/^T\+\d\d:\d\d:\d\d$/).waitFor();
    await head.getByText(/^UTC \d\d:\d\d:\d\d ± \d+\.\d s$/).waitFor();
    await head.getByText(/^scout’s clock \d\d:\d\d:\d\d$/).waitFor();
    await showRuns(app);
    const row = app.sheet.locator(".runs-row").getByText("running");
    await row.waitFor();
    robot.freeze();
    await app.sheet.locator(".runs-row.is-old .run-assumed").waitFor();
    robot.thaw();
    await endRun(robot, run);
  },
);

journey(
  "a machine of the robot is found by its path, started by the robot and shown",
  HERE,
  async ({ app, server, robot }) => {
    const { sheet } = app;
    await eventually(async () => {
      const list = await server.ask<RobotMachines>("GET", "/robots/scout/machines");
      return list.machines.length > 0;
    });
    await sheet.keyboard.press("Control+Alt+m");
    await sheet.keyboard.press("Control+Shift+p");
    const palette = sheet.getByRole("dialog", { name: "Search everything" });
    await palette.getByRole("combobox").pressSequentially("Start a machine of a robot\n");
    const dialog = sheet.getByRole("dialog", { name: "Start a machine of a robot" });
    await dialog.getByText(/^As the robot listed them at .* UTC by its calendar\.$/).waitFor();
    await dialog.getByRole("searchbox").fill("driv");
    await sheet.keyboard.press("Enter");
    await missionOf(app).locator(".mission-head").getByText("running").waitFor();
    const [run] = await server.ask<readonly RunSummary[]>("GET", "/runs");
    expect([run?.name, run?.robot]).toEqual(["drives", "scout"]);
    await endRun(robot, run?.id ?? "");
  },
);

journey(
  "in a blackout mission time stops with the data and shows its age, and never jumps back",
  HERE,
  async ({ app, server, robot }) => {
    const run = await startRun(robot, "drives");
    await untilRun(server, run, ({ phase }) => phase === "live");
    await openMission(app, "drives");
    const head = missionOf(app).locator(".mission-head");
    const time = head.locator(".mission-times dd").first();
    await time.getByText(/^T\+00:00:0[1-9]$/).waitFor();
    await time.evaluate((element) => {
      const seen = [element.textContent];
      new MutationObserver(() => {
        seen.push(element.textContent);
        element.dataset["seen"] = seen.join(" ");
      }).observe(element, { childList: true, characterData: true, subtree: true });
    });
    robot.freeze();
    await head.getByText(/^mission time, \d+ s ago$/).waitFor();
    robot.thaw();
    await head.getByText(/^mission time$/).waitFor();
    const before = await time.textContent();
    await eventually(async () => (await time.textContent()) !== before);
    const seen = (await time.getAttribute("data-seen"))?.split(" ") ?? [];
    expect(seen.length).toBeGreaterThan(1);
    expect(seen).toEqual([...seen].sort());
    await endRun(robot, run);
  },
);

journey(
  "mission control shows the next planned contact, and when a command is sent and takes effect",
  HERE,
  async ({ app, server, robot }) => {
    const run = await startRun(robot, "drives");
    await untilRun(server, run, ({ phase }) => phase === "live");
    await openMission(app, "drives");
    const link = missionOf(app).getByRole("region", { name: "Link to the robot" });
    await link.getByText("no contact planned").waitFor();
    await link.getByText(/^effect in /).waitFor();
    const at = (hours: number) => new Date(Date.now() + hours * 3_600_000).toISOString();
    const window = { begin: at(30), end: at(31), profile: "deep", note: "Kiruna" };
    await server.ask("PUT", "/robots/scout/contacts", [window]);
    await link.getByText(/^in 1 d \d.* UTC, profile deep, Kiruna$/).waitFor();
    await link.getByText(/^sent in 1 d \d.*, effect in 1 d \d.*, expires in 1 d \d/).waitFor();
    robot.freeze();
    await press(app, "Pause");
    const commands = link.getByRole("list", { name: "Commands on the way to the robot" });
    await commands.getByText(/^Pause of .*: to be sent in 1 d .*, takes effect in 1 d /).waitFor();
    const sent = missionOf(app).getByRole("list", { name: "Commands you sent" });
    await sent.getByText(/planned for the next contact in 1 d /).waitFor();
    robot.thaw();
    // The plan informs: what arrives earlier is carried out.
    await status(app).getByText("paused").waitFor();
    await commands.waitFor({ state: "detached" });
    await server.ask("PUT", "/robots/scout/contacts", []);
    await link.getByText("no contact planned").waitFor();
    await endRun(robot, run);
  },
);

journey(
  "a list of timed commands is reviewed, changed and released by mission control",
  HERE,
  async ({ app, server, robot }) => {
    const run = await startRun(robot, "drives");
    await untilRun(server, run, ({ phase }) => phase === "live");
    const in_ms = (ms: number) => new Date(Date.now() + ms).toISOString();
    await server.ask("PUT", "/robots/scout/commands", [
      { run, command: { type: "pause" } },
      { run: "never-was", command: { type: "stop" }, not_before: in_ms(3_600_000) },
    ]);
    await openMission(app, "drives");
    const list = missionOf(app).getByRole("group", { name: "Command list of scout" });
    await list.getByText("not released").waitFor();
    await list.getByText(/^Pause: sent at the release, takes effect in /).waitFor();
    await list.getByText(/the station has no open run of this robot with this id/).waitFor();
    const release = list.getByRole("button", { name: "Release…" });
    expect(await release.isDisabled()).toBe(true);
    await list.getByRole("button", { name: "Remove line 2" }).click();
    await list.getByText(/never-was/).waitFor({ state: "detached" });
    await release.click();
    await answer(app, "Release 1 command to scout?", "Release");
    await list.getByText(/: released by .* at /).waitFor();
    await status(app).getByText("paused").waitFor();
    await list.getByText("Pause: applied").waitFor();
    await list.getByRole("button", { name: "Begin a new list…" }).click();
    const form = list.getByRole("group", { name: "New command of the list" });
    await form.getByLabel("Command").selectOption("Resume");
    await form.getByLabel("Expires").selectOption("At a time (UTC)");
    await form.getByLabel("Expires at (UTC)").fill(in_ms(600_000));
    await form.getByRole("button", { name: "Add to the list" }).click();
    await list.getByText(/^Resume: sent at the release, takes effect in /).waitFor();
    await release.click();
    await answer(app, "Release 1 command to scout?", "Release");
    await list.getByText("Resume: applied").waitFor();
    await status(app).getByText("running").waitFor();
    await endRun(robot, run);
  },
);

journey("mission control plans a contact with a robot", HERE, async ({ app, server, robot }) => {
  const run = await startRun(robot, "drives");
  await untilRun(server, run, ({ phase }) => phase === "live");
  await openMission(app, "drives");
  await missionOf(app).getByRole("button", { name: "Plan contacts" }).click();
  const plan = missionOf(app).getByRole("group", { name: "Planned contacts with scout" });
  const add = plan.getByRole("button", { name: "Add contact" });
  await plan.getByLabel("Begin (UTC)").fill("2099-01-01 10:00");
  await plan.getByLabel("End (UTC)").fill("2099-01-01 09:00");
  await plan.getByLabel("Link profile").selectOption("deep");
  await plan.getByLabel("Note").fill("Kiruna");
  await add.click();
  await app.showsText(/end/);
  await plan.getByLabel("End (UTC)").fill("2099-01-01 10:20");
  await add.click();
  await plan
    .getByText(/^2099-01-01 10:00:00 UTC to .*10:20:00 UTC, profile deep, Kiruna$/)
    .waitFor();
  await missionOf(app)
    .getByText(/^in .*, 2099-01-01 10:00:00 UTC to .*deep, Kiruna$/)
    .waitFor();
  await plan.getByRole("button", { name: /^Remove the contact/ }).click();
  await missionOf(app).getByText("no contact planned").waitFor();
  await endRun(robot, run);
});

journey(
  "a run whose program died far away is resumed by mission control",
  HERE,
  async ({ app, server, robot }) => {
    const run = await startRun(robot, "drives");
    await untilRun(server, run, ({ phase }) => phase === "live");
    await openMission(app, "drives");
    for (const pid of runnersOf(robot, run)) process.kill(pid, "SIGKILL");
    const choices = missionOf(app).getByRole("region", { name: "The run crashed" });
    await choices.getByRole("button", { name: "Run scripts again" }).click();
    await app.showsText("scout is asked to resume the run.");
    await app.showsText("scout has resumed the run. Its first events are on their way.");
    await choices.waitFor({ state: "detached" });
    await missionOf(app).getByRole("button", { name: "Drive to the bay" }).waitFor();
    await endRun(robot, run);
  },
);

journey(
  "mission control starts the run of a robot again, which is shown once it arrives",
  HERE,
  async ({ app, server, robot }) => {
    const run = await startRun(robot, "drives");
    await untilRun(server, run, ({ phase }) => phase === "live");
    await openMission(app, "drives");
    await endRun(robot, run);
    await missionOf(app).getByRole("button", { name: "Start again…" }).click();
    const question = app.sheet.getByRole("dialog", { name: "Start the run again on scout?" });
    await question.getByRole("button", { name: "Start again" }).click();
    await app.showsText(
      "scout has started the run. It is shown here once its first events arrive.",
    );
    await app.until(
      ({ tab }, before) => (tab?.run.value?.id ?? before) !== before && tab !== null,
      run,
    );
    await missionOf(app).getByRole("button", { name: "Drive to the bay" }).waitFor();
    const again = await app.sheet.evaluate(() => window.__rafcon.context().tab?.run.value?.id);
    await endRun(robot, again ?? "");
  },
);

journey(
  "a replica that is not the run of its robot any more is named in lists, bars and mission control, with the way out",
  HERE,
  async ({ app, server, robot }) => {
    const run = await startRun(robot, "drives");
    await untilRun(server, run, ({ phase }) => phase === "live");
    await tell(robot, run, "pause");
    await openMission(app, "drives");
    await status(app).getByText("paused").waitFor();
    const putBack = keepDisk(robot, run);
    await tell(robot, run, "resume", "pause", "resume", "stop");
    await untilRun(server, run, ({ phase }) => phase === "finished");
    await robot.end();
    putBack();
    await robot.restart();
    await untilRun(robot, run, ({ phase }) => phase === "crashed");
    const again = { id: `resume-${run}`, policy: "restart", from: null };
    await robot.ask("POST", `/runs/${run}/resume`, again);
    await status(app).getByText("diverged").waitFor();
    await missionOf(app)
      .getByText(/takes nothing more; to receive the run anew, move /)
      .waitFor();
    await showRuns(app);
    await app.sheet.locator(".runs-row").getByText("diverged").waitFor();
    const bar = app.sheet.locator(".bar-danger");
    await bar.getByText(/^This replica has diverged: /).waitFor();
    await endRun(robot, run);
  },
);
