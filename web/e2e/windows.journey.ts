import type { Page as Sheet } from "playwright-core";
import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { startAndShow } from "./support/honest.ts";
import { journey } from "./support/journey.ts";

const HERE = { open: "hierarchy_and_data" };
const FULL = "PACKER/ISFULL";
const LABEL = "PACKER/LABELS";

/** A state in the tree of all states; the canvas has a tree for screen readers too. */
function inTree(sheet: Sheet, name: string) {
  return sheet
    .getByRole("tree", { name: "States", exact: true })
    .getByRole("treeitem", { name, exact: true });
}

/** Puts the panel's group into a window of its own. */
async function popOut(app: App, title: string): Promise<Sheet> {
  await app.panel(title);
  await app.sheet.getByRole("button", { name: `${title} panel menu` }).click();
  const coming = app.sheet.waitForEvent("popup");
  await app.sheet.getByRole("menuitem", { name: "Open in a window" }).click();
  const own = await coming;
  await own.getByRole("tab", { name: title, exact: true }).waitFor();
  await app.sheet.getByRole("tab", { name: title, exact: true }).waitFor({ state: "hidden" });
  return own;
}

journey("a panel works in a window of its own, and is docked again", HERE, async ({ app }) => {
  const own = await popOut(app, "Tree");
  await inTree(own, "Label the box").dblclick();
  await app.selected(`state:${LABEL}`);
  await own.keyboard.press("Delete");
  await inTree(own, "Label the box").waitFor({ state: "hidden" });
  await own.keyboard.press("Control+z");
  await inTree(own, "Label the box").waitFor();
  const closing = own.waitForEvent("close");
  await own.getByRole("button", { name: "Tree panel menu" }).click();
  await own.getByRole("menuitem", { name: "Dock" }).click();
  await closing;
  await app.panel("Tree");
  await inTree(app.sheet, "Label the box").waitFor();
});

journey("what is done in the page shows in the window at once", HERE, async ({ app }) => {
  const own = await popOut(app, "Tree");
  await app.select(FULL);
  await app.press("Delete");
  await inTree(own, "Is the box full").waitFor({ state: "hidden" });
});

journey("a window that is closed gives its panels back", HERE, async ({ app }) => {
  const own = await popOut(app, "Tree");
  await own.close({ runBeforeUnload: true });
  await app.panel("Tree");
  await inTree(app.sheet, "Label the box").waitFor();
});

journey("panels in a window stand in the page after a reload", HERE, async ({ app }) => {
  const own = await popOut(app, "Tree");
  const closing = own.waitForEvent("close");
  await app.sheet.reload();
  await closing;
  await app.connected();
  await app.panel("Tree");
  await inTree(app.sheet, "Label the box").waitFor();
});

/** Whether the time line is painted on the ground of the theme. */
async function isInColour(app: App): Promise<boolean> {
  return app.sheet.getByRole("slider", { name: "Moment of the run" }).evaluate((place) => {
    const canvas = place as HTMLCanvasElement;
    const ground = getComputedStyle(canvas).getPropertyValue("--sunken").trim();
    const pixel = canvas.getContext("2d")?.getImageData(2, canvas.height - 4, 1, 1).data ?? [];
    const hex = [...pixel].slice(0, 3).map((part) => part.toString(16).padStart(2, "0"));
    return `#${hex.join("")}` === ground;
  });
}

journey(
  "what a panel was given while another one was in front has its colours",
  HERE,
  async ({ app, server }) => {
    await app.command("Layout: Debug");
    await app.panel("Timeline");
    await app.panel("Log");
    await startAndShow(app, server, HERE.open);
    await app.until(({ tab }) => (tab?.run.value?.journal.length ?? 0) > 3, null);
    await app.panel("Timeline");
    await expect.poll(() => isInColour(app)).toBe(true);
  },
);
