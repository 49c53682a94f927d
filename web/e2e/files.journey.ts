import { readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";
import { examples } from "./support/places.ts";

const HERE = { open: "hierarchy_and_data" };
const FULL = "PACKER/ISFULL";

async function untilChanged(app: App, wanted: boolean): Promise<void> {
  await app.until(
    ({ tab }, value) => tab?.session.status.value?.summary.is_changed === value,
    wanted,
  );
}

/** The description of the root as it lies on disk. */
function onDisk(project: string, machine: string, file = "core_data.json"): string {
  return readFileSync(join(project, machine, file), "utf8");
}

journey("an edit marks the tab, and saving writes the files", HERE, async ({ app, server }) => {
  await app.select(FULL);
  await app.press("Delete");
  await untilChanged(app, true);
  await app.press("Control+s");
  await untilChanged(app, false);
  expect(onDisk(server.place.project, "hierarchy_and_data")).not.toContain("ISFULL");
});

journey("a machine is saved in another folder, where it stays", HERE, async ({ app, server }) => {
  await app.press("Control+Shift+s");
  const dialog = app.sheet.getByRole("dialog", { name: "Save as" });
  await dialog.getByLabel(/name/i).last().fill("packing");
  await dialog.getByRole("button", { name: "Save" }).click();
  await app.until(({ tab }) => tab?.session.status.value?.summary.file?.path === "packing", null);
  expect(onDisk(server.place.project, "packing")).toContain("PACKER");
});

journey(
  "a new machine is made, and opens",
  { machines: examples("mission") },
  async ({ app, server }) => {
    await app.sheet.getByRole("button", { name: "New machine" }).first().click();
    const dialog = app.sheet.getByRole("dialog", { name: "New machine" });
    await expect
      .poll(() => app.sheet.evaluate(() => getSelection()?.toString()))
      .toBe("New machine");
    await app.sheet.keyboard.type("Fetch the mug");
    await dialog.getByRole("button", { name: "Create" }).click();
    await app.until(({ tab }) => tab !== null, null);
    expect(onDisk(server.place.project, "fetch_the_mug")).toContain("Fetch the mug");
  },
);

journey(
  "a new machine goes into a new folder, and its place says whether it is a library",
  { machines: examples("mission") },
  async ({ app, server }) => {
    await app.sheet.getByRole("button", { name: "New machine" }).first().click();
    const dialog = app.sheet.getByRole("dialog", { name: "New machine" });
    await dialog.getByRole("treeitem", { name: "examples library root" }).click();
    await dialog.getByRole("textbox", { name: "Folder name" }).fill("kitchen/fetch");
    await dialog.getByText("as the library examples/kitchen/fetch").waitFor();
    await dialog.getByRole("button", { name: "Create" }).click();
    await app.until(({ tab }) => tab !== null, null);
    const folder = join(server.place.project, "libraries", "examples", "kitchen", "fetch");
    expect(readdirSync(folder)).toContain("statemachine.json");
  },
);

journey(
  "what another program changed on disk is told, and can be taken",
  HERE,
  async ({ app, server }) => {
    const file = join(server.place.project, "hierarchy_and_data", "core_data.json");
    writeFileSync(file, readFileSync(file, "utf8").replace("Pack an order", "Pack two orders"));
    await app.until(({ tab }) => tab?.session.status.value?.summary.disk !== "same", null);
    await app.command("Reload from disk");
    await app.until(
      ({ tab }) => tab?.session.machine.state(tab.session.machine.root)?.name === "Pack two orders",
      null,
    );
  },
);

journey(
  "saving over what another program changed asks first, and loses nothing",
  HERE,
  async ({ app, server }) => {
    await app.select(FULL);
    await app.press("Delete");
    await app.settled();
    const file = join(server.place.project, "hierarchy_and_data", "core_data.json");
    writeFileSync(file, readFileSync(file, "utf8").replace("Pack an order", "Pack two orders"));
    await app.press("Control+s");
    const dialog = app.sheet.getByRole("dialog", { name: /Another program changed the files/ });
    await dialog.getByRole("button", { name: /Overwrite with mine/ }).click();
    await untilChanged(app, false);
    expect(readFileSync(file, "utf8")).not.toContain("Pack two orders");
  },
);

journey(
  "machines stand as tabs, and one that changed is closed with a question",
  {
    open: "hierarchy_and_data",
    machines: examples("error_recovery"),
  },
  async ({ app }) => {
    await app.open("error_recovery");
    const tabs = app.sheet.getByRole("tablist", { name: "Open machines" });
    await tabs.getByRole("tab", { name: /Pack an order/ }).click();
    await app.select(FULL);
    await app.press("Delete");
    await untilChanged(app, true);
    await app.press("Control+Alt+w");
    const dialog = app.sheet.getByRole("dialog", { name: /before closing/ });
    await dialog.getByRole("button", { name: /discard edits/ }).click();
    await app.until(({ page }) => page.tabs.value.length === 1, null);
  },
);

journey(
  "the first machine that is found is opened by Enter, another one by the arrows",
  { machines: examples("error_recovery", "hierarchy_and_data"), libraries: {} },
  async ({ app }) => {
    const dialog = app.sheet.getByRole("dialog", { name: "Open a machine" });
    const find = async (text: string) => {
      await app.sheet.keyboard.press("Control+o");
      await dialog.getByRole("searchbox").fill(text);
      await dialog.getByRole("treeitem", { name: "error_recovery", exact: true }).waitFor();
    };
    const isOpen = (name: string) =>
      app.until(({ tab }, path) => tab?.session.status.value?.summary.file?.path === path, name);
    await find("r");
    await app.sheet.keyboard.press("Enter");
    await isOpen("error_recovery");
    await find("r");
    await app.sheet.keyboard.press("ArrowDown");
    await app.sheet.keyboard.press("ArrowDown");
    await app.sheet.keyboard.press("Enter");
    await isOpen("hierarchy_and_data");
  },
);

journey("the page that is loaded again comes back as it was", HERE, async ({ app }) => {
  await app.select(FULL);
  await app.sheet.reload();
  await app.until(({ tab }) => tab?.session.machine.root === "PACKER", null);
});

journey("edits outlive a server that was killed", HERE, async ({ app, server }) => {
  await app.select(FULL);
  await app.press("Delete");
  await app.settled();
  await server.end("SIGKILL");
  await app.until(({ page }) => page.server.link.value.state === "down", null);
  await server.restart();
  await app.connected();
  await app.until(({ tab }) => tab?.session.machine.state("PACKER/ISFULL") === undefined, null);
  expect(await app.children()).toEqual(["Label the box", "Pack one part"]);
});

journey(
  "an edit without a link waits, and is done when the server is back",
  HERE,
  async ({ app, server }) => {
    await app.select(FULL);
    await server.end();
    await app.until(({ page }) => page.server.link.value.state === "down", null);
    await app.press("Delete");
    await app.until(({ tab }) => (tab?.session.pending.value.length ?? 0) > 0, null);
    await server.restart();
    await app.settled();
    expect(await app.children()).toEqual(["Label the box", "Pack one part"]);
  },
);

journey(
  "an edit on its way to a server that dies is done once, when it is back",
  HERE,
  async ({ app, server }) => {
    await app.select(FULL);
    server.freeze();
    await app.press("Control+d");
    await app.until(({ tab }) => (tab?.session.pending.value.length ?? 0) > 0, null);
    await server.end("SIGKILL");
    await server.restart();
    await app.connected();
    await app.settled();
    expect((await app.children()).length).toBe(4);
  },
);

journey(
  "an edit that is made while the server dies is done once, whatever it got of it",
  HERE,
  async ({ app, server }) => {
    for (const count of [4, 5, 6, 7]) {
      const { x, y } = await app.spot("PACKER", 40 * (count - 3), 330);
      await app.sheet.mouse.move(x, y);
      await app.press("e");
      await server.end("SIGKILL");
      await server.restart();
      await app.connected();
      await app.settled();
      expect((await app.children()).length).toBe(count);
    }
  },
);

journey(
  "an edit that the server never got and refuses is said to be undone",
  HERE,
  async ({ app, server }) => {
    await app.select(FULL);
    await server.end();
    await app.until(({ page }) => page.server.link.value.state === "down", null);
    await app.press("Delete");
    rmSync(join(server.place.project, "hierarchy_and_data"), { recursive: true });
    rmSync(join(server.place.folder, "state", "drafts"), { recursive: true, force: true });
    await server.restart();
    await app.settled();
    await app.until(
      ({ page }) => page.notices.value.some(({ text }) => text.includes("was not applied")),
      null,
    );
  },
);
