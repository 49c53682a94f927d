import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";

const HERE = { open: "library_reuse" };

/** Finds a library in the panel and opens its menu. */
async function menuOf(app: App, name: string): Promise<void> {
  await app.panel("Libraries");
  await app.sheet.getByPlaceholder("Filter libraries").fill(name);
  await app.sheet.getByRole("treeitem", { name, exact: true }).click({ button: "right" });
}

journey("a library is put in the place of a state, which keeps its name", HERE, async ({ app }) => {
  const path = await app.path("Announce the patrol");
  await app.select(path);
  await menuOf(app, "grasp");
  await app.sheet.getByRole("menuitem", { name: "Substitute selected state" }).click();
  await app.sheet
    .getByRole("menuitem", { name: "With the library, keep the state's name" })
    .click();
  await app.until(({ tab }, at) => tab?.session.machine.state(at)?.library?.name === "grasp", path);
  await app.settled();
  expect((await app.state(path)).name).toBe("Announce the patrol");
});

journey("a copy of a library comes with its states", HERE, async ({ app }) => {
  await menuOf(app, "grasp");
  await app.sheet.getByRole("menuitem", { name: "Add as copy" }).click();
  await app.until(
    ({ tab }) => tab?.session.machine.children(tab.session.machine.root).length === 6,
    null,
  );
  await app.settled();
  const copy = await app.path("Grasp");
  expect((await app.state(copy)).kind).not.toBe("library");
});

journey("where a library is used is listed, and leads there", HERE, async ({ app }) => {
  await menuOf(app, "drive_square");
  await app.sheet.getByRole("menuitem", { name: "Show where it is used" }).click();
  const used = app.sheet.getByRole("tree", { name: "Uses of drive_square" });
  await used.getByRole("treeitem", { name: /Drive a large square/ }).click();
  await app.selected(`state:${await app.path("Drive a large square")}`);
});

journey("the menu of the tree is that of the canvas", HERE, async ({ app }) => {
  await app.panel("Tree");
  const tree = app.sheet.getByRole("tree", { name: "States", exact: true });
  const row = tree.getByRole("treeitem", { name: /Drive a small square/ });
  await row.click({ button: "right" });
  await app.sheet.getByRole("menuitem", { name: /^Delete/ }).click();
  await app.settled();
  expect(await app.children()).not.toContain("Drive a small square");
});

/** Another program gives the library of announcements one more input. */
function giveInput(folder: string): void {
  const file = join(folder, "speech", "announce", "core_data.json");
  const state = JSON.parse(readFileSync(file, "utf8"));
  const port = { ...state.input_data_ports["1"], data_port_id: 2, name: "loudness" };
  state.input_data_ports["2"] = port;
  writeFileSync(file, JSON.stringify(state, null, 4));
}

journey(
  "a library that another program changed is taken over, and given back",
  HERE,
  async (hands) => {
    const { app, server } = hands;
    const path = await app.path("Announce the patrol");
    const inputs = async () => (await app.state(path)).inputs?.map(({ name }) => name);
    expect(await inputs()).toEqual(["message", "subject"]);
    giveInput(server.place.libraries["examples"] ?? "");
    await app.panel("Libraries");
    const changed = app.sheet.getByRole("region", { name: "Changed libraries" });
    const own = changed.getByRole("listitem").filter({ hasText: "“Announce the patrol”: " });
    await own.getByText(/the input `loudness: object` is new/).waitFor();
    await own.getByRole("button", { name: /^Take/ }).click();
    await app.until(({ tab }, at) => tab?.session.machine.state(at)?.inputs?.length === 3, path);
    expect(await inputs()).toEqual(["message", "subject", "loudness"]);
    await own.waitFor({ state: "detached" });
    await app.press("Control+z");
    await app.until(({ tab }, at) => tab?.session.machine.state(at)?.inputs?.length === 2, path);
    await own.getByText(/is new/).waitFor();
  },
);

journey("a library state shows its library in the tree of libraries", HERE, async ({ app }) => {
  const path = await app.path("Announce the patrol");
  await app.click(await app.ground(path), "right");
  await app.sheet.getByRole("menuitem", { name: "Show in library tree" }).click();
  const tree = app.sheet.getByRole("tree", { name: "Libraries", exact: true });
  await tree.getByRole("treeitem", { name: "announce", selected: true }).waitFor();
});
