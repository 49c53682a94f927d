/** Questions of states, answered in mission control: by text, by boxes, by choice, and by nobody. */

import { expect } from "vitest";
import type { Moment } from "../src/model/generated/protocol.ts";
import { journey } from "./support/journey.ts";
import { endRun, missionFolder, missionOf, openMission, startRun } from "./support/mission.ts";

const DRIVE = { id: "DRIVEE", name: "Drive to the bay", script: ["self.preemptive_wait(3600)"] };
const ASK = "from rafcon import dialog";

const ASKS = missionFolder("asks", [
  {
    id: "LABELS",
    name: "Label the box",
    script: [
      ASK,
      'label = dialog.text("What stands on the box?", "box 7", timeout=3600, default="nothing")',
      'gvm.set_variable("label", label.text)',
    ],
  },
  {
    id: "GRIPPE",
    name: "Choose grippers",
    script: [
      ASK,
      'clean = dialog.checks("Which grippers are clean?", ["left", "right", "spare"], [True, False, False])',
      'gvm.set_variable("clean", list(clean.checked))',
    ],
  },
  {
    id: "WAYWAY",
    name: "Choose a way",
    script: [
      ASK,
      'way = dialog.ask("Is the way free?", ["Yes", "Wait", "Go around"])',
      'gvm.set_variable("way", way.label)',
    ],
  },
  DRIVE,
]);

journey(
  "a line of text, boxes and a choice are answered in mission control, and get to the scripts",
  { machines: { asks: ASKS }, open: "asks" },
  async ({ app, server }) => {
    const run = await startRun(server, "asks");
    await openMission(app, "asks");
    const mission = missionOf(app);
    const form = (question: string) => mission.getByRole("form", { name: question });
    const text = form("What stands on the box?");
    await text.getByText("then “OK: “nothing”” is used").waitFor();
    expect(await text.getByLabel("Your answer").inputValue()).toBe("box 7");
    await text.getByLabel("Your answer").fill("box 9");
    await text.getByRole("button", { name: "OK" }).click();
    await mission.getByText("owner answered “OK: “box 9””").waitFor();
    const boxes = form("Which grippers are clean?");
    await boxes.getByText(/without a timeout/).waitFor();
    expect(await boxes.getByLabel("left").isChecked()).toBe(true);
    await boxes.getByLabel("left").uncheck();
    await boxes.getByLabel("right").check();
    await boxes.getByLabel("spare").check();
    await boxes.getByRole("button", { name: "OK" }).click();
    await mission.getByText("owner answered “OK: right, spare”").waitFor();
    await form("Is the way free?").getByRole("button", { name: "Go around" }).click();
    await mission.getByText("owner answered “Go around”").waitFor();
    await mission.getByRole("button", { name: "Drive to the bay" }).waitFor();
    const { globals } = await server.ask<Moment>("GET", `/runs/${run}/moments`);
    expect(globals).toMatchObject({ label: "box 9", clean: [false, true, true], way: "Go around" });
    await endRun(server, run);
  },
);

const LATE = missionFolder("late", [
  {
    id: "EMPTYY",
    name: "Look into the gripper",
    script: [
      ASK,
      'answer = dialog.ask("Is the gripper empty?", ["yes", "no"], timeout=0.5, default="no")',
      'gvm.set_variable("empty", [answer.label, answer.timed_out])',
    ],
  },
  {
    id: "MAYYYY",
    name: "Ask to go",
    script: [ASK, 'dialog.ask("May I go?", ["Go"], timeout=0.5)'],
  },
  DRIVE,
]);

journey(
  "of a question that no one answers in time the author's answer counts, or the state fails",
  { machines: { late: LATE }, open: "late" },
  async ({ app, server }) => {
    const run = await startRun(server, "late");
    await openMission(app, "late");
    const mission = missionOf(app);
    const closed = mission.getByRole("list", { name: "Closed questions" });
    const line = (question: string) => closed.getByRole("listitem").filter({ hasText: question });
    await line("Is the gripper empty?").getByText("nobody answered in time: “no”").waitFor();
    await line("May I go?").getByText("nobody answered in time", { exact: true }).waitFor();
    await mission.getByRole("form").waitFor({ state: "detached" });
    const events = mission.getByRole("region", { name: "Events to acknowledge" });
    await events
      .getByText(/nobody answered within 0\.5 s: May I go\?/)
      .first()
      .waitFor();
    await mission.getByRole("button", { name: "Drive to the bay" }).waitFor();
    const { globals } = await server.ask<Moment>("GET", `/runs/${run}/moments`);
    expect(globals["empty"]).toEqual(["no", true]);
    await endRun(server, run);
  },
);
