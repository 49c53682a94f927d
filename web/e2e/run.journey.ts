/** Runs by the page: started, paused, stepped, held, steered and stopped. */

import { expect } from "vitest";
import type { Moment } from "../src/model/generated/protocol.ts";
import { journey } from "./support/journey.ts";
import { examples } from "./support/places.ts";
import {
  answer,
  ended,
  heldBefore,
  heldInside,
  left,
  perform,
  press,
  runInFront,
  stands,
  stopRun,
  untilActive,
  untilEndReceived,
} from "./support/runs.ts";
import type { Server } from "./support/server.ts";

const PACKER = "PACKER";
const ONE_PART = "PACKER/ONEPAR";

journey(
  "a run is started, paused, resumed and stopped by the buttons",
  { open: "preemptive_with_timer" },
  async ({ app }) => {
    await app.menu("Run", "Start with…");
    const dialog = app.sheet.getByRole("dialog", { name: /^Start / });
    await dialog.getByLabel("hidden_at_deg").fill("45");
    await dialog.getByLabel("limit_s").fill("600.0");
    await dialog.getByRole("button", { name: "Start", exact: true }).click();
    await stands(app, "running");
    await press(app, "Pause");
    await stands(app, "paused");
    await press(app, "Resume");
    await stands(app, "running");
    await app.press("F7");
    await stands(app, "paused");
    await app.press("F7");
    await stands(app, "running");
    await app.press("F8");
    await answer(app, "Stop the run?", "Keep running");
    await stands(app, "running");
    await stopRun(app);
    await ended(app, "preempted");
    await stands(app, "finished");
  },
);

journey(
  "a start takes values for inputs, refuses what is none, and remembers them",
  { open: "hierarchy_and_data" },
  async ({ app, server }) => {
    await app.menu("Run", "Start with…");
    const dialog = app.sheet.getByRole("dialog", { name: /^Start / });
    const wanted = dialog.getByLabel("wanted: int");
    await wanted.fill("two");
    await dialog.getByText(/is not a value/).waitFor();
    await wanted.fill("2");
    await dialog.getByRole("button", { name: "Start", exact: true }).click();
    await ended(app, "success");
    const run = await runInFront(app);
    const last = await server.ask<{ events: readonly { event: { type: string } }[] }>(
      "GET",
      `/runs/${run}/events?from=1&kind=finished`,
    );
    expect(JSON.stringify(last)).toContain("2 parts");
    await app.menu("Run", "Start with…");
    expect(await wanted.inputValue()).toBe("2");
    await app.sheet.keyboard.press("Escape");
  },
);

journey(
  "steps go into, over and out of a hierarchy, and back again with the data as they were",
  { open: "hierarchy_and_data" },
  async ({ app, server }) => {
    await app.menu("Run", "Start paused");
    await heldBefore(app, `${PACKER}/ISFULL`);
    const run = await runInFront(app);
    const count = async () => {
      const picture = await server.ask<Moment>("GET", `/runs/${run}/moments`);
      return picture.active.find(({ path }) => path === PACKER)?.scoped["count"];
    };
    await press(app, "Into");
    await heldBefore(app, ONE_PART);
    await app.press("F4");
    await heldBefore(app, `${ONE_PART}/PICKIT`);
    await untilActive(app, ONE_PART);
    await app.press("F3");
    await heldBefore(app, `${PACKER}/ISFULL`);
    await expect.poll(count).toBe(1);
    await press(app, "Over");
    await heldBefore(app, ONE_PART);
    await app.press("Shift+F4");
    await heldBefore(app, `${PACKER}/ISFULL`);
    await expect.poll(count).toBe(2);
    await press(app, "Back");
    await heldInside(app, ONE_PART);
    await app.press("F9");
    await heldBefore(app, `${ONE_PART}/PLACEI`);
    await app.press("F9");
    await heldBefore(app, ONE_PART);
    await expect.poll(count).toBe(1);
    await press(app, "Resume");
    await ended(app, "success");
  },
);

/** Puts each device test of the barrier into a hierarchy of its own: branches of scripts alone cannot be held. */
async function boxed(server: Server): Promise<void> {
  const file = { project: "missions", path: "barrier_with_decider" };
  const { id } = await server.ask<{ id: string }>("POST", "/machines/open", { file });
  for (const [state, box, name] of [
    ["ARMARM", "ARMBOX", "Test the arm"],
    ["CAMERA", "CAMBOX", "Test the camera"],
  ]) {
    const edit = {
      edit: "group",
      path: "SLFTST/ALLDEV",
      states: [state],
      scoped_variables: [],
      id: box,
      name,
    };
    const step = { id: `box-${box}`, base: 1, name: "Group", edit };
    await server.ask("POST", `/machines/${id}/edits`, step);
  }
  await server.ask("POST", `/machines/${id}/save`, { overwrite: false });
}

journey(
  "branches of a barrier are stepped each by itself",
  { machines: examples("barrier_with_decider") },
  async ({ app, server }) => {
    await boxed(server);
    await app.open("barrier_with_decider");
    await app.menu("Run", "Start paused");
    await heldBefore(app, "SLFTST/ALLDEV");
    await press(app, "Into");
    const [arm, camera] = ["SLFTST/ALLDEV/ARMBOX", "SLFTST/ALLDEV/CAMBOX"];
    await heldBefore(app, `${arm}/ARMARM`);
    await heldBefore(app, `${camera}/CAMERA`);
    await app.panel("Running");
    await perform(app, "run.over", camera);
    await left(app, camera);
    await heldBefore(app, `${arm}/ARMARM`);
    await perform(app, "run.into", arm);
    await left(app, arm);
    await heldBefore(app, "SLFTST/WARNIN");
    await press(app, "Back");
    await untilActive(app, "SLFTST/ALLDEV");
    await press(app, "Resume");
    await ended(app, "degraded");
  },
);

journey(
  "a state of a preemptive concurrency is preempted by hand, and its cleaning up runs",
  { open: "preemptive_with_timer" },
  async ({ app }) => {
    await app.menu("Run", "Start with…");
    const dialog = app.sheet.getByRole("dialog", { name: /^Start / });
    await dialog.getByLabel("hidden_at_deg").fill("45");
    await dialog.getByLabel("limit_s").fill("600.0");
    await dialog.getByRole("button", { name: "Start", exact: true }).click();
    await untilActive(app, "SEARCH/ORTIME/LOOKER");
    await app.select("SEARCH/ORTIME/LOOKER");
    await app.command("Preempt state");
    await untilEndReceived(app);
    const ends = await app.sheet.evaluate(() => {
      const journal = window.__rafcon.page.active.value?.run.value?.journal;
      const all = [...Array(journal?.length ?? 0).keys()].map((index) => journal?.at(index));
      return all.flatMap((event) =>
        event?.kind === "left" ? [`${event.path} ${event.outcome?.name}`] : [],
      );
    });
    expect(ends).toContain("SEARCH/ORTIME/LOOKER/FOLDIT success");
    expect(ends).toContain("SEARCH/ORTIME/LOOKER preempted");
  },
);

journey(
  "a breakpoint with a condition is set on the border, and holds in the third round only",
  { open: "hierarchy_and_data" },
  async ({ app, server }) => {
    const box = await app.box(ONE_PART);
    await app.click({ x: box.x + 16, y: box.y });
    await app.panel("Breakpoints");
    await app.sheet.getByText("For the next start, kept in this browser").waitFor();
    await app.sheet.getByRole("button", { name: "Edit breakpoint 1" }).click();
    const dialog = app.sheet.getByRole("dialog", { name: "Breakpoint 1" });
    await dialog.getByLabel("Condition (Python)").fill('inputs["count"] == 2');
    await dialog.getByRole("button", { name: "Set", exact: true }).click();
    await press(app, "Start");
    await heldBefore(app, ONE_PART);
    await app.sheet.locator(".run-chooser").getByText("breakpoint 1").waitFor();
    const picture = await server.ask<Moment>("GET", `/runs/${await runInFront(app)}/moments`);
    expect(picture.active.find(({ path }) => path === PACKER)?.scoped["count"]).toBe(2);
    await app.sheet.getByText("1 hit").waitFor();
    await press(app, "Resume");
    await ended(app, "success");
  },
);

journey(
  "a run goes to a state, one state runs alone, and a state is skipped by its outcome",
  { open: "hierarchy_and_data" },
  async ({ app }) => {
    const label = `${PACKER}/LABELS`;
    await app.select(label);
    await app.command("Run to here");
    await heldBefore(app, label);
    await perform(app, "run.force-outcome", { path: label, outcome: 0 });
    await ended(app, "success");
    const first = await runInFront(app);
    await app.select(`${PACKER}/ISFULL`);
    await app.command("Run this state only");
    await app.until(({ tab }, before) => {
      const watch = tab?.run.value;
      return watch != null && watch.id !== before && watch.now.value?.run.phase === "finished";
    }, first);
    await untilEndReceived(app);
    const entered = await app.sheet.evaluate(() => {
      const journal = window.__rafcon.page.active.value?.run.value?.journal;
      const all = [...Array(journal?.length ?? 0).keys()].map((index) => journal?.at(index));
      return all.flatMap((event) => (event?.kind === "entered" ? [event.path] : []));
    });
    expect(entered).toEqual([PACKER, `${PACKER}/ISFULL`]);
    await app.sheet.locator(".run-chooser").click();
    await app.sheet.getByRole("menuitemcheckbox").nth(1).click();
    await app.until(({ tab }, id) => tab?.run.value?.id === id, first);
  },
);

journey(
  "edits are saved before a start, and taken into a run in progress",
  { open: "hierarchy_and_data" },
  async ({ app }) => {
    const rename = async (name: string) => {
      await app.select(`${PACKER}/LABELS`);
      await app.press("F2");
      await app.sheet.keyboard.type(name);
      await app.sheet.keyboard.press("Enter");
      await app.until(
        ({ tab }, wanted) =>
          tab?.session.machine.state("PACKER/LABELS")?.name === wanted &&
          tab.session.status.value?.summary.is_changed === true,
        name,
      );
    };
    await rename("Write the label");
    await app.menu("Run", "Start paused");
    await app.sheet.getByRole("button", { name: /^Save and start/ }).click();
    await heldBefore(app, `${PACKER}/ISFULL`);
    await rename("Print the label");
    await app.showsText(/edited since/);
    await app.sheet.getByRole("button", { name: "Apply edits to the run" }).click();
    await app.showsText(/now uses the edited machine/);
    await app.sheet.getByText(/edited since/).waitFor({ state: "detached" });
    await press(app, "Resume");
    await ended(app, "success");
  },
);

journey(
  "a start whose answer got lost is said again, and starts one run",
  { open: "hierarchy_and_data" },
  async ({ app, server }) => {
    let count = 0;
    await app.sheet.route("**/api/v1/runs", async (route) => {
      if (route.request().method() !== "POST") return route.continue();
      count += 1;
      if (count > 1) return route.continue();
      await route.fetch();
      return route.abort("connectionreset");
    });
    await press(app, "Start");
    await ended(app, "success");
    expect(count).toBe(2);
    expect(await server.ask<unknown[]>("GET", "/runs")).toHaveLength(1);
  },
);

journey(
  "two runs of a machine continue at once, are switched between, and are found and deleted in the panel",
  { open: "hierarchy_and_data" },
  async ({ app, server }) => {
    await app.menu("Run", "Start paused");
    await heldBefore(app, `${PACKER}/ISFULL`);
    const first = await runInFront(app);
    await app.menu("Run", "Start paused");
    await answer(app, "Start another run?", "Start another");
    await app.until(({ tab }, id) => tab?.run.value?.id !== id, first);
    await heldBefore(app, `${PACKER}/ISFULL`);
    await press(app, "Resume");
    await ended(app, "success");
    const second = await runInFront(app);
    await app.panel("Runs");
    const rows = app.sheet.getByRole("list", { name: "Runs" }).getByRole("listitem");
    await rows.nth(1).waitFor();
    expect(await rows.count()).toBe(2);
    await app.sheet.getByLabel("Find runs").fill("paused");
    await rows.nth(1).waitFor({ state: "detached" });
    await rows
      .first()
      .getByRole("button", { name: /Pack an order/ })
      .click();
    await app.until(({ tab }, id) => tab?.run.value?.id === id, first);
    await stands(app, "stepping");
    await stopRun(app);
    await app.sheet.getByLabel("Find runs").fill("success");
    await app.sheet
      .getByRole("button", { name: new RegExp(`Actions for the run ${second}`) })
      .click();
    await app.sheet.getByRole("menuitem", { name: "Show the machine as it ran" }).click();
    await app.until(({ tab }) => tab?.session.fixed !== null, null);
    await app.sheet
      .getByRole("button", { name: new RegExp(`Actions for the run ${second}`) })
      .click();
    await app.sheet.getByRole("menuitem", { name: "Delete…" }).click();
    await answer(app, "Delete this run?", "Delete");
    await app.until(({ page }) => page.tabs.value.length === 1, null);
    await app.until(({ page }) => page.runs.all.value.length === 1, null);
    const left = await server.ask<readonly { id: string }[]>("GET", "/runs");
    expect(left.map(({ id }) => id)).toEqual([first]);
  },
);
