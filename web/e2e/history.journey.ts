import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";

const HERE = { open: "hierarchy_and_data" };
const ROOT = "PACKER";
const FULL = "PACKER/ISFULL";

/** Renames a state in place of whoever would type it. */
async function rename(app: App, path: string, name: string): Promise<void> {
  await app.sheet.evaluate(
    ([at, text]) => {
      const session = window.__rafcon?.page.active.value?.session;
      return session?.edit(`Rename to ${text}`, { edit: "set_name", path: at, name: text });
    },
    [path, name] as const,
  );
  await app.settled();
}

journey("the history goes back to any step, and on to another branch", HERE, async ({ app }) => {
  for (const name of ["One", "Two", "Three"]) await rename(app, FULL, name);
  await app.panel("Edits");
  const steps = app.sheet.getByRole("grid", { name: "Steps, newest first" });
  await steps.getByText("Rename to One").click();
  await app.sheet.getByRole("button", { name: "Go to this step" }).click();
  await expect.poll(async () => (await app.state(FULL)).name).toBe("One");
  await rename(app, FULL, "Four");
  await expect.poll(() => steps.getByRole("row").count()).toBe(6);
  await app.sheet.getByLabel("Branches").uncheck();
  await expect.poll(() => steps.getByRole("row").count()).toBe(4);
  await app.sheet.getByLabel("Branches").check();
  await steps.getByText("Rename to Three").dblclick();
  await expect.poll(async () => (await app.state(FULL)).name).toBe("Three");
});

journey("what a step changed stands beside it", HERE, async ({ app }) => {
  await rename(app, FULL, "Another name");
  await app.panel("Edits");
  const steps = app.sheet.getByRole("grid", { name: "Steps, newest first" });
  await steps.getByText("Rename to Another name").click();
  const detail = app.sheet.getByRole("region", { name: "Differences of Another name" });
  await expect.poll(() => detail.textContent()).toContain("Is the box full → Another name");
});

journey("what differs from the disk is listed, and marked on the canvas", HERE, async ({ app }) => {
  await app.panel("Differences");
  await app.sheet.getByRole("button", { name: "Compare with the version on disk" }).click();
  await expect.poll(() => app.sheet.getByText("No differences").count()).toBe(1);
  await rename(app, FULL, "Another name");
  const list = app.sheet.getByRole("grid", { name: "Differences" });
  await list.getByText("name: Is the box full → Another name").click();
  await app.selected(`state:${FULL}`);
  const marks = await app.sheet.evaluate(() => [
    ...(window.__rafcon?.page.active.value?.view.marks.value ?? []),
  ]);
  expect(marks).toEqual([[`state:${FULL}`, "changed"]]);
});

journey("a problem leads to its place, and goes when it is mended", HERE, async ({ app }) => {
  await app.sheet.evaluate((path) => {
    const session = window.__rafcon?.page.active.value?.session;
    return session?.edit("Take the start away", { edit: "set_start", path, to: null });
  }, ROOT);
  await app.panel("Problems");
  await app.sheet.getByText("no child is where it starts").click();
  await app.selected(`state:${ROOT}`);
  await app.canvas.focus();
  await app.press("Control+z");
  await expect.poll(() => app.sheet.getByText("No problems").count()).toBe(1);
});
