/** Runs that are longer than what the page keeps: it has the newest part, and asks for the others when they are looked at. */

import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { linkIs, startAndShow } from "./support/honest.ts";
import { journey } from "./support/journey.ts";
import { FALLEN, FAST_PACKER, longRun } from "./support/long_run.ts";
import { LONG_WORK } from "./support/patience.ts";
import { activeShown, momentShown, replayed, ruler, shown, showsMoment } from "./support/time.ts";

const HERE = { machines: { packer: FAST_PACKER }, open: "packer" };
/** More than the page keeps. */
const EVENTS = 260_000;

interface Part {
  readonly isWhole: boolean;
  readonly from: number;
  readonly next: number;
  readonly length: number;
  readonly last: number;
}

/** What the page has of the run around the moment that it shows. */
function part(app: App): Promise<Part> {
  return app.sheet.evaluate(() => {
    const watch = window.__rafcon.page.active.value?.run.value;
    if (!watch) throw new Error("no run is shown");
    const { window: here, journal } = watch;
    const [from, next, length] = [here.from, here.next, here.length];
    return { isWhole: here.base === null, from, next, length, last: journal.next - 1 };
  });
}

async function covers(app: App, sequence: number): Promise<void> {
  const isIn = async () => {
    const { from, next } = await part(app);
    return from <= sequence && sequence < next;
  };
  await expect.poll(isIn).toBe(true);
}

journey(
  "a long run opens with its newest events; any other moment is one step away, also after a break",
  HERE,
  async ({ app, server }) => {
    const run = await longRun(server, "packer", EVENTS);
    await shown(app, run);
    const newest = await part(app);
    expect(newest.isWhole).toBe(false);
    expect(newest.length).toBeLessThan(20_000);
    expect(newest.last).toBeGreaterThan(200_000);
    const timeline = app.sheet.locator(".timeline-rows[data-drawn='whole']");
    await app.panel("Timeline");
    await timeline.waitFor();
    // A moment in the middle of the time.
    const { x, y, width } = await ruler(app);
    await app.sheet.mouse.click(x + width / 2, y);
    await expect.poll(() => momentShown(app)).not.toBeNull();
    const middle = (await momentShown(app)) ?? 0;
    const [until, whole] = [middle, newest.last].map((at) => replayed(server, run, at).t_ns);
    expect((until ?? 0) / (whole ?? 0)).toBeGreaterThan(0.4);
    expect((until ?? 0) / (whole ?? 0)).toBeLessThan(0.6);
    await covers(app, middle);
    expect(await activeShown(app)).toEqual(
      replayed(server, run, middle).active.map(({ path }) => path),
    );
    // The server goes and comes: what is shown stays.
    await server.end("SIGKILL");
    await linkIs(app, "down");
    await server.restart();
    await linkIs(app, "up");
    await showsMoment(app, middle);
    await covers(app, middle);
    // The first event.
    await app.panel("Run history");
    await app.sheet.getByRole("button", { name: "Show the first events" }).click();
    await showsMoment(app, 1);
    await covers(app, 1);
    expect((await part(app)).isWhole).toBe(true);
    // An early event is found.
    const search = app.sheet.getByLabel("Search the history: states, outcomes, log");
    await search.fill("fell from");
    const found = app.sheet.getByRole("tree", { name: "Search results in the run" });
    await found.getByText(`part ${FALLEN} fell from the gripper`).click();
    await expect.poll(() => momentShown(app)).toBeGreaterThan(FALLEN * 8);
    await search.fill("");
    await covers(app, (await momentShown(app)) ?? 0);
    await app.sheet.getByRole("tree", { name: "Calls of the run, in order" }).waitFor();
    await app.sheet.getByRole("button", { name: "Go to the end" }).click();
    await showsMoment(app, null);
    expect((await part(app)).next - 1).toBe(newest.last);
  },
);

journey(
  "a run grows beyond what the page keeps while one looks at its start",
  HERE,
  async ({ app, server }) => {
    await startAndShow(app, server, "packer", { inputs: { wanted: 30_000 } });
    await app.until(({ tab }) => (tab?.run.value?.journal.length ?? 0) > 10, null);
    await app.sheet.evaluate(() => {
      const watch = window.__rafcon.page.active.value?.run.value;
      if (watch) watch.playhead.value = 3;
    });
    const isOver = () =>
      app.sheet.evaluate(() => {
        const watch = window.__rafcon.page.active.value?.run.value;
        return watch?.now.value?.run.phase === "finished" && watch.isCaughtUp.value;
      });
    await expect.poll(isOver, LONG_WORK).toBe(true);
    const here = await part(app);
    expect(here.last).toBeGreaterThan(200_000);
    expect(here.from).toBe(1);
    await showsMoment(app, 3);
    const journal = await app.sheet.evaluate(() => {
      const there = window.__rafcon.page.active.value?.run.value?.journal;
      return { length: there?.length ?? 0, isWhole: there?.base === null };
    });
    expect(journal.isWhole).toBe(false);
    expect(journal.length).toBeLessThan(200_001);
  },
);
