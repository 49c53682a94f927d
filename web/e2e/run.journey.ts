/** Runs by the page: started, paused, stepped, held, steered and stopped. */

import { expect } from "vitest";
import type { Picture } from "../src/model/generated/protocol.ts";
import { journey } from "./house/journey.ts";
import {
  answer,
  ended,
  heldBefore,
  isActive,
  press,
  runInFront,
  stands,
  stopRun,
} from "./house/runs.ts";

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
    await press(app, "Stop");
    await answer(app, "Stop the run?", "Go on");
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
    await dialog.getByText(/is no value/).waitFor();
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
    await app.menu("Run", "Start held");
    await heldBefore(app, `${PACKER}/ISFULL`);
    const run = await runInFront(app);
    const count = async () => {
      const picture = await server.ask<Picture>("GET", `/runs/${run}/moments`);
      return picture.active.find(({ path }) => path === PACKER)?.scoped["count"];
    };
    await press(app, "Into");
    await heldBefore(app, ONE_PART);
    await press(app, "Into");
    await heldBefore(app, `${ONE_PART}/PICKIT`);
    await isActive(app, ONE_PART);
    await press(app, "Out");
    await heldBefore(app, `${PACKER}/ISFULL`);
    await expect.poll(count, { timeout: 20_000 }).toBe(1);
    await press(app, "Over");
    await heldBefore(app, ONE_PART);
    await press(app, "Over");
    await heldBefore(app, `${PACKER}/ISFULL`);
    await expect.poll(count, { timeout: 20_000 }).toBe(2);
    await press(app, "Back");
    await isActive(app, ONE_PART);
    await app.press("F9");
    await app.press("F9");
    await heldBefore(app, ONE_PART);
    await expect.poll(count, { timeout: 20_000 }).toBe(1);
    await press(app, "Resume");
    await ended(app, "success");
  },
);
