/** The short form of the journeys in Firefox: from a new machine to a run that is stopped in mission control. */

import { mkdirSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { expect, test, vi } from "vitest";
import { App } from "./support/app.ts";
import { Firefox } from "./support/firefox.ts";
import { PATIENCE } from "./support/patience.ts";
import { newPlace, RESULTS } from "./support/places.ts";
import { Server } from "./support/server.ts";

test("in Firefox a machine is made, drawn, saved, run and stopped", async () => {
  const server = await Server.start(newPlace({}));
  const firefox = await Firefox.launch();
  try {
    await go(new App(firefox.sheet, server), server);
  } catch (error) {
    mkdirSync(RESULTS, { recursive: true });
    writeFileSync(join(RESULTS, "firefox.png"), await firefox.picture());
    throw error;
  } finally {
    await firefox.close();
    await server.dispose();
  }
});

async function go(app: App, server: Server): Promise<void> {
  const { sheet } = app;
  await sheet.goto(server.link);
  await app.until(({ page }) => page.server.link.value.state === "up", null);

  // A new machine.
  await sheet.getByRole("button", { name: "New machine" }).click();
  const dialog = sheet.getByRole("dialog", { name: "New machine" });
  await dialog.getByRole("textbox", { name: "Name of the machine" }).fill("Fetch");
  await sheet.keyboard.press("Enter");
  await app.until(({ tab, canvas }) => tab !== null && canvas !== null, null);
  await app.drawn();

  // Two states, the first with another name, one after the other.
  const root = await sheet.evaluate(
    () => window.__rafcon.context().tab?.session.machine.root ?? "",
  );
  const [one, two] = [await add(app, root, 15, 25), await add(app, root, 60, 60)];
  await app.select(one);
  await app.press("F2");
  await sheet.keyboard.press("Control+a");
  await sheet.keyboard.type("Look\n");
  await app.until(({ tab }, path) => tab?.session.machine.state(path)?.name === "Look", one);
  await app.drag(await app.port(root, "income"), await app.port(one, "income"));
  await app.drag(await app.port(one, "outcome", "success"), await app.port(two, "income"));
  await app.settled();
  expect((await app.state(root)).transitions?.length).toBe(2);

  // A script that takes its time.
  await app.select(two);
  await sheet.getByRole("textbox", { name: `Script of ${(await app.state(two)).name}` }).click();
  await sheet.keyboard.press("Control+Home");
  await sheet.keyboard.press("End");
  await sheet.keyboard.type("\nself.preemptive_wait(600)");
  await sheet.keyboard.press("Control+Enter");
  await app.until(
    ({ tab }, path) => tab?.session.machine.state(path)?.script?.includes("wait(600)") === true,
    two,
  );

  // It is saved, and runs.
  await app.press("Control+s");
  await app.until(({ tab }) => tab?.session.status.value?.summary.is_changed === false, null);
  const folders = readdirSync(join(server.place.project, "fetch"));
  expect(folders.filter((name) => name.startsWith("Look_"))).toHaveLength(1);
  await app.press("Shift+F7");
  await app.until(({ tab }, path) => {
    const active = tab?.run.value?.now.value?.snapshot?.active ?? [];
    return active.some((state) => state.path === path);
  }, two);

  // The time line knows what has ended, and mission control stops it.
  await sheet.keyboard.press("Control+Shift+p");
  const palette = sheet.getByRole("dialog", { name: "Search everything" });
  await palette.getByRole("combobox").pressSequentially("Layout: Debug\n");
  await app.panel("Timeline");
  await sheet.getByRole("button", { name: "Live" }).waitFor();
  await sheet.keyboard.press("Control+Alt+m");
  // Who presses again at once is asked once only, so this presses until the run has ended.
  const strike = async () => {
    await sheet.locator(".mission-stop").click();
    return sheet.evaluate(
      () => window.__rafcon.context().tab?.run.value?.now.value?.run.phase === "finished",
    );
  };
  await vi.waitUntil(strike, PATIENCE);
}

/** Adds a state by key and drags it to its place: its path. */
async function add(app: App, root: string, x: number, y: number): Promise<string> {
  await app.press("Escape");
  await app.click(await app.spot(root, x, y));
  await app.press("e");
  await app.settled();
  const [key = ""] = await app.selection();
  return key.replace("state:", "");
}
