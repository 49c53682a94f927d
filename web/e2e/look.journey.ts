import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";

const HERE = { open: "hierarchy_and_data" };
const ROOT = "PACKER";
const PART = "PACKER/ONEPAR";
const PICK = "PACKER/ONEPAR/PICKIT";

const scale = (app: App) =>
  app.sheet.evaluate(() => window.__rafcon.context().tab?.view.camera.value.scale ?? 0);

journey("the wheel zooms at the pointer, and all is fitted again", HERE, async ({ app }) => {
  const [before, at] = [await scale(app), await app.middle(PICK)];
  await app.sheet.mouse.move(at.x, at.y);
  await app.sheet.mouse.wheel(0, -240);
  await app.until(({ tab }, was) => (tab?.view.camera.value.scale ?? 0) > was * 1.2, before);
  const after = await app.middle(PICK);
  expect(Math.hypot(after.x - at.x, after.y - at.y)).toBeLessThan(2);
  await app.press("f");
  await app.until(
    ({ tab }, was) => Math.abs((tab?.view.camera.value.scale ?? 0) - was) < was * 0.01,
    before,
  );
});

journey("a double click goes into a state, the breadcrumb leads out", HERE, async ({ app }) => {
  const before = await scale(app);
  const at = await app.spot(PART, 200, 160);
  await app.sheet.mouse.dblclick(at.x, at.y);
  await app.until(({ tab }, was) => (tab?.view.camera.value.scale ?? 0) > was * 1.2, before);
  const path = app.sheet.getByRole("navigation", { name: "Breadcrumb" });
  await path.getByRole("button", { name: "Pack an order" }).click();
  await app.until(
    ({ tab }, was) => Math.abs((tab?.view.camera.value.scale ?? 0) - was) < was * 0.01,
    before,
  );
});

journey(
  "states between give way above the canvas, and are reached by a menu",
  { ...HERE, browser: { viewport: { width: 1280, height: 720 } } },
  async ({ app }) => {
    await app.select(PICK);
    const path = app.sheet.getByRole("navigation", { name: "Breadcrumb" });
    const crumbs = () => path.getByRole("listitem").allTextContents();
    await expect.poll(crumbs).toEqual(["Pack an order", "…", "Pick from the belt"]);
    await path.getByRole("button", { name: "1 state in between" }).click();
    await app.sheet.getByRole("menuitem", { name: "Pack one part" }).click();
    await app.selected(`state:${PART}`);
    await expect.poll(crumbs).toEqual(["Pack an order", "Pack one part"]);
  },
);

journey("layers of the picture are shown and hidden", HERE, async ({ app }) => {
  await app.press("d");
  await app.until(({ tab }) => tab?.view.modes.value.dataFlows === "all", null);
  await app.press("t");
  await app.until(({ tab }) => tab?.view.modes.value.transitions === false, null);
});

journey("the theme changes, and stays after the page is loaded again", HERE, async ({ app }) => {
  await app.command("Theme: Dark");
  const ground = () => app.sheet.evaluate(() => getComputedStyle(document.body).colorScheme);
  await app.until(({ page }) => page.settings.value.theme === "dark", null);
  await app.sheet.reload();
  await app.connected();
  await app.until(({ page }) => page.settings.value.theme === "dark", null);
  expect(await ground()).toContain("dark");
});

journey("the theme goes by the system's while no one chose one", HERE, async ({ app }) => {
  const root = app.sheet.locator(":root");
  const text = () => app.sheet.evaluate(() => getComputedStyle(document.body).color);
  await app.sheet.emulateMedia({ colorScheme: "dark" });
  await root.and(app.sheet.locator("[data-theme=dark]")).waitFor();
  const onDark = await text();
  await app.sheet.emulateMedia({ colorScheme: "light" });
  await root.and(app.sheet.locator("[data-theme=light]")).waitFor();
  expect(await text()).not.toBe(onDark);
});

journey("the content of a library shows in place", { open: "library_reuse" }, async ({ app }) => {
  const square = await app.path("Drive a small square");
  await app.select(square);
  await app.press("Shift+l");
  await app.until(
    ({ tab }, path) =>
      (tab?.session.machine.children(path).length ?? 0) === 1 &&
      tab?.view.contents.value.get(path) === true,
    square,
  );
  expect(await app.children(square)).toEqual(["Drive a square"]);
});

journey("everything of the canvas is reached by keyboard", HERE, async ({ app }) => {
  await app.canvas.focus();
  await app.press("s");
  await app.selected(`state:${ROOT}/ISFULL`);
  await app.press("ArrowRight");
  await app.until(({ tab }) => !tab?.view.selection.value.has("state:PACKER/ISFULL"), null);
  await app.press("F2");
  await app.sheet.keyboard.press("Control+a");
  await app.sheet.keyboard.type("Told by keys");
  await app.sheet.keyboard.press("Enter");
  await app.settled();
  expect(await app.children()).toContain("Told by keys");
});

/** The part of the page that the canvas has. */
const share = (app: App) =>
  app.sheet.evaluate(() => {
    const box = document.querySelector(".canvas-place")?.getBoundingClientRect();
    return ((box?.width ?? 0) * (box?.height ?? 0)) / (innerWidth * innerHeight);
  });

journey(
  "on a small page, as at 200 %, panels fold and one bar stands for all",
  HERE,
  async ({ app, server }) => {
    const side = app.sheet.getByRole("button", { name: "Right side" });
    await app.sheet.setViewportSize({ width: 800, height: 500 });
    await expect.poll(() => share(app)).toBeGreaterThan(0.7);
    await side.click();
    await app.sheet.getByRole("textbox", { name: "Version" }).waitFor();
    await side.click();
    const file = join(server.place.project, "hierarchy_and_data", "core_data.json");
    writeFileSync(file, readFileSync(file, "utf8").replace("Pack an order", "Pack two orders"));
    const other = app.sheet.getByText("Another program changed the files");
    await other.waitFor();
    await server.end("SIGKILL");
    await app.sheet.getByText("No connection for").waitFor();
    await other.waitFor({ state: "hidden" });
    await expect.poll(() => share(app)).toBeGreaterThan(0.6);
    await app.sheet.getByRole("button", { name: "Show the other bars" }).click();
    await other.waitFor();
    await app.sheet.setViewportSize({ width: 1600, height: 1000 });
    for (const tab of ["Tree", "Problems", "Inspector"])
      await app.sheet.getByRole("tab", { name: tab, exact: true }).waitFor();
  },
);

journey("sides are as wide as before after a visit to 200 %", HERE, async ({ app }) => {
  const width = () =>
    app.canvas.evaluate((canvas) => Math.round(canvas.getBoundingClientRect().width));
  const before = await width();
  for (let visit = 0; visit < 2; visit += 1) {
    await app.sheet.setViewportSize({ width: 800, height: 500 });
    await expect.poll(width).toBeGreaterThan(700);
    await app.sheet.setViewportSize({ width: 1600, height: 1000 });
    await expect.poll(width).toBe(before);
  }
});

/** What is smaller than this in one direction, of all that can be pressed. What only screen readers see is no target. */
const smallerThan = (app: App, least: number) =>
  app.sheet.evaluate((size) => {
    const targets = document.querySelectorAll(
      "button, select, input, [role=tab], [role=treeitem], [role=menuitem], .table-row",
    );
    return [...targets].flatMap((target) => {
      const { width, height } = (target.closest("label") ?? target).getBoundingClientRect();
      const isSeen = width > 1 && height > 1 && !target.closest(".visually-hidden, [inert]");
      const name = target.getAttribute("aria-label") ?? target.textContent;
      const isFit = height >= size - 0.5 && width >= size - 0.5;
      return isSeen && !isFit ? [`${name}: ${width} x ${height}`] : [];
    });
  }, least);

for (const [pointer, least, browser] of [
  ["a mouse", 24, {}],
  ["fingers", 32, { hasTouch: true, viewport: { width: 1024, height: 768 } }],
] as const) {
  journey(
    `what can be pressed is large enough for ${pointer}`,
    { ...HERE, browser },
    async ({ app }) => {
      await app.select(PART);
      for (const panel of ["Tree", "Libraries", "Globals", "Edits", "Problems"]) {
        await app.panel(panel);
        expect(await smallerThan(app, least)).toEqual([]);
      }
      await app.press("Shift+F10");
      await app.sheet.getByRole("menu").waitFor();
      expect(await smallerThan(app, least)).toEqual([]);
    },
  );
}
