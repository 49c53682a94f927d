import { expect } from "vitest";
import type { App } from "./house/app.ts";
import { journey } from "./house/journey.ts";

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
  await app.sheet.getByRole("menuitem", { name: "By the library, keep its name" }).click();
  await app.settled();
  const state = await app.state(path);
  expect([state.name, state.library?.name]).toEqual(["Announce the patrol", "grasp"]);
});

journey("a copy of a library comes with its states", HERE, async ({ app }) => {
  await menuOf(app, "grasp");
  await app.sheet.getByRole("menuitem", { name: "Add as copy" }).click();
  await app.until(
    ({ tab }) => tab?.room.machine.children(tab.room.machine.root).length === 6,
    null,
  );
  await app.settled();
  const copy = await app.path("Grasp");
  expect((await app.state(copy)).kind).not.toBe("library");
});

journey("where a library is used is listed, and leads there", HERE, async ({ app }) => {
  await menuOf(app, "drive_square");
  await app.sheet.getByRole("menuitem", { name: "Show where it is used" }).click();
  const used = app.sheet.getByRole("tree", { name: "Where drive_square is used" });
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
