/** The time of a run: scrubbed, stepped, searched, begun again, compared; what the page shows is what the command line tells. */

import { expect } from "vitest";
import type { Comparison, Moment } from "../src/model/generated/protocol.ts";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";
import { ended, heldBefore, press, runInFront } from "./support/runs.ts";
import type { Server } from "./support/server.ts";
import {
  activeShown,
  finished,
  historyOf,
  innermost,
  momentShown,
  replayed,
  ruler,
  shown,
  showsMoment,
  started,
} from "./support/time.ts";

const TENTHS = [1, 2, 3, 4, 5, 6, 7, 8, 9];

/** Drags along the ruler to each tenth of a run, and looks at the page there. */
async function scrub(app: App, at: (moment: number) => Promise<void>): Promise<void> {
  const { x, y, width } = await ruler(app);
  const { mouse } = app.sheet;
  await mouse.move(x + width / 2, y);
  await mouse.down();
  for (const tenth of [...TENTHS].reverse()) {
    await mouse.move(x + (width * tenth) / 10, y, { steps: 3 });
    const playhead = await momentShown(app);
    if (playhead === null) throw new Error(`at ${tenth} tenths the page shows the current state`);
    await at(playhead);
  }
  await mouse.up();
}

async function samePicture(app: App, server: Server, run: string, moment: number): Promise<void> {
  const paths = replayed(server, run, moment).active.map(({ path }) => path);
  expect(await activeShown(app)).toEqual(paths);
}

journey(
  "each tenth of a run with branches shows what ran then, in words too",
  { open: "preemptive_with_timer" },
  async ({ app, server }) => {
    const run = await finished(server, "preemptive_with_timer");
    await shown(app, run);
    await app.panel("Timeline");
    await scrub(app, async (moment) => {
      await samePicture(app, server, run, moment);
      const rows = app.sheet.getByRole("list", { name: "Active now" });
      const names = async () => (await rows.locator(".running-name").allTextContents()).sort();
      const wanted = innermost(replayed(server, run, moment));
      await expect.poll(names).toEqual(wanted);
    });
    await app.sheet.getByRole("button", { name: "Go to the end" }).click();
    await showsMoment(app, null);
  },
);

journey(
  "each tenth of a mission shows what ran then",
  { open: "mission" },
  async ({ app, server }) => {
    const run = await finished(server, "mission");
    await shown(app, run);
    await app.panel("Timeline");
    await scrub(app, (moment) => samePicture(app, server, run, moment));
  },
);

journey(
  "a run is stepped through event by event, forwards and back, by keys",
  { open: "hierarchy_and_data" },
  async ({ app, server }) => {
    const run = await finished(server, "hierarchy_and_data");
    const moves = historyOf(server, run).filter(
      ({ event }) => !["scoped", "global"].includes(event.type),
    );
    await shown(app, run);
    await app.panel("Timeline");
    const slider = app.sheet.getByRole("slider", { name: "Moment of the run" });
    await slider.focus();
    await app.sheet.keyboard.press("Home");
    for (const { sequence } of moves.slice(0, 12)) {
      await showsMoment(app, sequence);
      await samePicture(app, server, run, sequence);
      await app.sheet.keyboard.press("ArrowRight");
    }
    await app.sheet.keyboard.press("ArrowLeft");
    await showsMoment(app, moves[11]?.sequence);
    await app.sheet.evaluate(() => {
      const view = window.__rafcon.page.active.value?.view;
      if (view) view.selection.value = new Set(["state:PACKER/ONEPAR"]);
    });
    const entries = moves.filter(
      ({ event }) => event.type === "entered" && event.path === "PACKER/ONEPAR",
    );
    await app.sheet.keyboard.press("Home");
    for (const { sequence } of entries.slice(0, 3)) {
      await app.sheet.keyboard.press("Control+ArrowRight");
      await showsMoment(app, sequence);
    }
    await app.sheet.keyboard.press("Control+ArrowLeft");
    await showsMoment(app, entries[1]?.sequence);
    const inWords = () => slider.getAttribute("aria-valuetext");
    await expect.poll(inWords).toMatch(/Pack one part entered$/);
    await app.sheet.keyboard.press("End");
    await showsMoment(app, null);
  },
);

journey(
  "a press on a bar shows its moment and selects its state; the wheel zooms, a lane folds",
  { open: "preemptive_with_timer" },
  async ({ app, server }) => {
    const run = await finished(server, "preemptive_with_timer");
    await shown(app, run);
    await app.panel("Timeline");
    const rows = await app.sheet.getByRole("slider", { name: "Moment of the run" }).boundingBox();
    if (!rows) throw new Error("there is no time line");
    const { x, y } = await ruler(app);
    const middle = x + rows.width * 0.5;
    // How long a start takes does not matter then.
    await app.sheet.evaluate(() => {
      const view = window.__rafcon.page.active.value?.view;
      if (view) view.selection.value = new Set(["state:SEARCH"]);
    });
    await app.sheet.getByRole("button", { name: "Zoom to the selected state" }).click();
    await app.click({ x: middle, y: rows.y + 30 });
    await app.selected("state:SEARCH/ORTIME");
    const playhead = await momentShown(app);
    if (playhead === null) throw new Error("the page shows the current state");
    await samePicture(app, server, run, playhead);
    expect(await activeShown(app)).toContain("SEARCH/ORTIME");
    const fold = app.sheet.getByRole("button", { name: "One row of Look around" });
    await fold.click();
    await app.sheet.getByRole("button", { name: "All levels of Look around" }).waitFor();
    await app.click({ x: x + rows.width * 0.3, y: rows.y + 3 + 36 + 6 + 9 });
    await app.until(
      ({ tab }) =>
        [...(tab?.view.selection.value ?? [])][0]?.startsWith("state:SEARCH/ORTIME/LOOKER/") ??
        false,
      null,
    );
    await app.sheet.mouse.move(middle, y);
    for (let turn = 0; turn < 5; turn++) await app.sheet.mouse.wheel(0, -300);
    await app.click({ x: x + rows.width * 0.02, y });
    const early = await momentShown(app);
    await app.sheet.getByRole("button", { name: "Fit the whole run" }).click();
    await app.click({ x: x + rows.width * 0.02, y });
    expect(await momentShown(app)).toBeLessThan(early ?? 0);
  },
);

journey(
  "the search of the time line steps through what it finds",
  { open: "hierarchy_and_data" },
  async ({ app, server }) => {
    const run = await finished(server, "hierarchy_and_data");
    const entries = historyOf(server, run).filter(
      ({ event }) => event.type === "entered" && event.path.endsWith("/ONEPAR/PICKIT"),
    );
    await shown(app, run);
    await app.panel("Timeline");
    const field = app.sheet.getByRole("searchbox", { name: /^Search the run/ });
    await field.fill("pick from");
    await app.sheet.getByText(`– of ${entries.length}`, { exact: true }).waitFor();
    for (const { sequence } of entries.slice(0, 3)) {
      await field.press("Enter");
      await showsMoment(app, sequence);
    }
    await app.sheet.getByText(`3 of ${entries.length}`, { exact: true }).waitFor();
    await field.press("Shift+Enter");
    await showsMoment(app, entries[1]?.sequence);
    await field.fill("no such words");
    await app.sheet.getByText("No hits", { exact: true }).waitFor();
  },
);

journey(
  "the history tree folds loops, finds states, and leads to their moments",
  { open: "preemptive_with_timer" },
  async ({ app, server }) => {
    const run = await finished(server, "preemptive_with_timer");
    await shown(app, run);
    await app.panel("Run history");
    const tree = app.sheet.getByRole("tree", { name: "Calls of the run, in order" });
    const open = async (name: RegExp) => {
      const row = tree.getByRole("treeitem", { name }).first();
      await row.click();
      if ((await row.getAttribute("aria-expanded")) === "false") {
        await app.sheet.keyboard.press("ArrowRight");
      }
    };
    await open(/^Search or time out/);
    await open(/Look around/);
    await open(/Look, Turn × 5/);
    await open(/Round 2/);
    await tree.getByRole("treeitem", { name: /^Turn/ }).first().click();
    const turns = historyOf(server, run).filter(
      ({ event }) => event.type === "entered" && event.path.endsWith("/TURNIT"),
    );
    await showsMoment(app, turns[1]?.sequence);
    await app.sheet.getByRole("searchbox", { name: /^Search the history/ }).fill("seen");
    const hit = app.sheet.getByRole("treeitem", { name: /Look ended with seen/ });
    await hit.dblclick();
    const seen = historyOf(server, run).find(
      ({ event }) => event.type === "left" && event.outcome.name === "seen",
    );
    await showsMoment(app, seen?.sequence);
  },
);

journey(
  "a run that is held begins again at an entry of its history",
  { open: "hierarchy_and_data" },
  async ({ app, server }) => {
    const point = {
      id: 1,
      path: "PACKER/ONEPAR",
      when: "after",
      condition: null,
      hit_count: 3,
      scope: "run",
      unattended: "hold",
      enabled: true,
    };
    const run = await started(server, "hierarchy_and_data", { breakpoints: [point] });
    await shown(app, run);
    const untilHeld = () =>
      app.until(
        ({ tab }) =>
          tab?.run.value?.now.value?.snapshot?.active.some(({ held }) => held.length > 0) ?? false,
        null,
      );
    await untilHeld();
    await app.panel("Timeline");
    const entries = () =>
      historyOf(server, run).filter(
        ({ event }) => event.type === "entered" && event.path === "PACKER/ONEPAR",
      );
    await expect.poll(() => entries().length).toBeGreaterThan(1);
    const second = entries()[1]?.sequence ?? 0;
    await app.sheet.evaluate((sequence) => {
      const watch = window.__rafcon.page.active.value?.run.value;
      if (watch) watch.playhead.value = sequence;
    }, second);
    await app.sheet.getByRole("button", { name: "Start from here" }).click();
    await app.until(({ tab }, sequence) => {
      const journal = tab?.run.value?.journal;
      return [...(journal?.others() ?? [])].some(
        ([, event]) => event.type === "went_back" && event.sequence === sequence,
      );
    }, second);
    await showsMoment(app, null);
    await app.panel("Run history");
    await app.sheet
      .getByRole("treeitem", { name: /interrupted/ })
      .first()
      .waitFor();
    await server.ask("POST", `/runs/${run}/commands`, {
      id: "time-stop",
      command: { type: "stop" },
    });
    await app.until(({ tab }) => tab?.run.value?.now.value?.link === "over", null);
  },
);

journey(
  "a run that is over begins again at an entry of its history, with the data it had then",
  { open: "hierarchy_and_data" },
  async ({ app, server }) => {
    const run = await finished(server, "hierarchy_and_data");
    await shown(app, run);
    await app.panel("Run history");
    await app.sheet.getByRole("searchbox", { name: /^Search the history/ }).fill("pick from");
    const hits = app.sheet.getByRole("treeitem", { name: /Pick from the belt/ });
    await hits.nth(2).click({ button: "right" });
    const menu = app.sheet.getByRole("menu", { name: "Actions for this event" });
    await menu.getByRole("menuitem", { name: "Start from here" }).click();
    await heldBefore(app, "PACKER/ONEPAR/PICKIT");
    const entries = () =>
      historyOf(server, run).filter(
        ({ event }) => event.type === "entered" && event.path === "PACKER/ONEPAR/PICKIT",
      );
    const count = ({ active }: Moment) =>
      active.find(({ path }) => path === "PACKER")?.scoped["count"];
    const now = await server.ask<Moment>("GET", `/runs/${run}/moments`);
    expect(count(now)).toBe(2);
    expect(count(replayed(server, run, entries()[2]?.sequence ?? 0))).toBe(2);
    expect(entries()).toHaveLength(5);
    await press(app, "Resume");
    await ended(app, "success");
    expect(await runInFront(app)).toBe(run);
    await expect.poll(() => entries().length).toBe(8);
  },
);

journey(
  "two runs are compared, and each side of their first difference leads to its moment",
  { open: "preemptive_with_timer" },
  async ({ app, server }) => {
    const far = await finished(server, "preemptive_with_timer");
    const near = await finished(server, "preemptive_with_timer", { inputs: { hidden_at_deg: 60 } });
    const compared = await server.ask<Comparison>("GET", `/runs/${near}/compare/${far}`);
    const [parted] = compared.parted;
    if (!parted?.one || !parted.other) throw new Error("the runs do not diverge");
    await shown(app, near);
    await app.panel("Compare runs");
    await app.sheet.getByLabel("The other run").selectOption(far);
    const part = app.sheet.getByRole("button", { name: /^Runs diverge here/ });
    await part.nth(1).waitFor();
    expect(await part.allTextContents()).toEqual([
      expect.stringContaining("Look ended with seen"),
      expect.stringContaining("Look ended with nothing here"),
    ]);
    await part.first().click();
    await showsMoment(app, parted.one.sequence);
    await part.last().click();
    await app.until(({ tab }, id) => tab?.run.value?.id === id, far);
    await showsMoment(app, parted.other.sequence);
    await app.until(
      ({ tab }, key) => tab?.view.marks.value?.has(key) ?? false,
      `state:${parted.other.path}`,
    );
    const times = app.sheet.getByRole("grid", { name: "Time in states, in both runs" });
    await times.getByText("Look", { exact: true }).waitFor();
  },
);
