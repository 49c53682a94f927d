import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { expect } from "vitest";
import { journey } from "./support/journey.ts";

const HERE = { open: "hierarchy_and_data" };
const LABEL = "PACKER/LABELS";
const PLACE = "PACKER/ONEPAR/PLACEI";

journey("a state is found by the palette, and flown to", HERE, async ({ app }) => {
  await app.sheet.keyboard.press("Control+k");
  await app.sheet.getByRole("combobox", { name: "Search" }).fill("place in");
  await app.sheet.getByRole("option", { name: /Place in the box/ }).click();
  await app.selected(`state:${PLACE}`);
  expect((await app.box(PLACE)).width).toBeGreaterThan(100);
});

journey("words of a script are found by the search", HERE, async ({ app }) => {
  await app.panel("Search");
  await app.sheet.getByPlaceholder("Names, ports, scripts, values…").fill("the label says");
  const found = app.sheet.getByLabel("Search results");
  await found
    .getByText(/Label the box/)
    .first()
    .dblclick();
  await app.selected(`state:${LABEL}`);
});

journey("the tree leads to a state", HERE, async ({ app }) => {
  await app.panel("Tree");
  await app.sheet.getByPlaceholder("Filter states").fill("place in");
  await app.sheet.getByRole("treeitem", { name: /Place in the box/ }).dblclick();
  await app.selected(`state:${PLACE}`);
});

journey(
  "a library is dragged from its tree onto the canvas",
  { open: "library_reuse" },
  async ({ app }) => {
    await app.panel("Libraries");
    await app.sheet.getByPlaceholder("Filter libraries").fill("grasp");
    const grasp = app.sheet.getByRole("treeitem", { name: /grasp/ });
    await app.sheet.getByRole("treeitem", { name: /drive_to/ }).waitFor({ state: "hidden" });
    const root = await app.box(await app.path("Patrol"));
    const frame = (await app.canvas.boundingBox()) ?? root;
    const targetPosition = {
      x: root.x - frame.x + root.width * 0.4,
      y: root.y - frame.y + root.height * 0.8,
    };
    await grasp.dragTo(app.canvas, { targetPosition });
    await app.until(
      ({ tab }) => tab?.session.machine.children(tab.session.machine.root).length === 6,
      null,
    );
    expect(await app.children()).toContain("Grasp");
  },
);

journey("a problem is listed with its way out, and leads to its place", HERE, async ({ app }) => {
  await app.select(LABEL);
  await app.press("Delete");
  await app.settled();
  await app.panel("Problems");
  const list = app.sheet.getByRole("grid", { name: "Problems, most severe first" });
  await list.getByRole("row").nth(1).dblclick();
  await app.until(({ tab }) => (tab?.view.selection.value.size ?? 0) === 1, null);
});

journey("what differs from the files is listed and marked", HERE, async ({ app }) => {
  await app.select(LABEL);
  await app.press("Delete");
  await app.settled();
  await app.command("Compare with disk or an earlier version…");
  const list = app.sheet.getByLabel("Differences", { exact: true });
  await list
    .getByText(/Label the box/)
    .first()
    .waitFor();
});

journey("a machine is compared with what git has", HERE, async ({ app, server }) => {
  const { project } = server.place;
  const { spawnSync } = await import("node:child_process");
  const git = (...words: string[]) => {
    const identity = ["-c", "user.name=anna", "-c", "user.email=anna@localhost"];
    const { status, stderr } = spawnSync("git", [...identity, ...words], { cwd: project });
    if (status !== 0) throw new Error(String(stderr));
  };
  git("init", "--quiet");
  git("add", ".");
  git("commit", "--quiet", "--message", "The first one");
  const file = join(project, "hierarchy_and_data", "core_data.json");
  writeFileSync(file, readFileSync(file, "utf8").replace("Pack an order", "Pack two orders"));
  await app.command("Reload from disk");
  await app.until(
    ({ tab }) => tab?.session.machine.state(tab.session.machine.root)?.name === "Pack two orders",
    null,
  );
  await app.panel("Differences");
  const against = app.sheet.getByLabel("Compare with");
  await app.sheet.getByRole("option", { name: /The first one/ }).waitFor({ state: "attached" });
  const value = await app.sheet
    .getByRole("option", { name: /The first one/ })
    .first()
    .getAttribute("value");
  await against.selectOption(value ?? "");
  const list = app.sheet.getByLabel("Differences", { exact: true });
  await list
    .getByText(/Pack an order/)
    .first()
    .waitFor();
});
