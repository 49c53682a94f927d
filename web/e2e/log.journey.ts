/** The log: what states say, tied to them, to moments and to lines of their scripts. */

import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { startAndShow } from "./support/honest.ts";
import { journey } from "./support/journey.ts";
import { endRun, missionFolder } from "./support/mission.ts";
import { momentShown } from "./support/time.ts";

const TALK = missionFolder("talk", [
  {
    id: "GREETT",
    name: "Greet",
    script: ['print("hello")', 'self.logger.debug("a detail")', 'return "success"'],
  },
  {
    id: "TURNNN",
    name: "Turn",
    script: ['self.logger.warning("the wheel sticks")', 'return "success"'],
  },
  { id: "FAILLL", name: "Find the way", script: ["way = {}", 'return way["out"]'] },
  {
    id: "TICKKK",
    name: "Tick",
    script: [
      "n = 0",
      "while not self.preemptive_wait(0.05):",
      "    n += 1",
      '    print("tick", n)',
      'return "preempted"',
    ],
  },
]);

const HERE = { machines: { talk: TALK }, open: "talk" };

function log(app: App) {
  return app.sheet.getByRole("grid", { name: "Log", exact: true });
}

async function begin(app: App, server: Parameters<typeof startAndShow>[1]): Promise<string> {
  const run = await startAndShow(app, server, "talk");
  await app.panel("Log");
  await log(app)
    .getByText(/^tick \d+$/)
    .first()
    .waitFor();
  return run;
}

journey(
  "the log follows, and is filtered by level, text and state",
  HERE,
  async ({ app, server }) => {
    const run = await begin(app, server);
    const { sheet } = app;
    // Which ticks are in sight when one looks is by chance: some late one is.
    await log(app)
      .getByText(/^tick ([4-9]\d|\d{3,})$/)
      .first()
      .waitFor();
    await sheet.getByRole("checkbox", { name: "Follow", exact: true }).uncheck();
    await sheet.getByLabel("Level", { exact: true }).selectOption("warning");
    await log(app).getByText("the wheel sticks").waitFor();
    await log(app).getByText(/^tick/).first().waitFor({ state: "detached" });
    await sheet.getByLabel("Level", { exact: true }).selectOption("verbose");
    await sheet.getByLabel("Filter the log").fill("DETAIL");
    await log(app).getByText("a detail").waitFor();
    await log(app).getByText("the wheel sticks").waitFor({ state: "detached" });
    await sheet.getByLabel("Filter the log").fill("");
    await app.select(await app.path("Turn"));
    await sheet.getByRole("checkbox", { name: "Selection only" }).check();
    await log(app).getByText("hello").waitFor({ state: "detached" });
    await log(app).getByText("the wheel sticks").waitFor();
    await expect.poll(() => log(app).getByRole("row").count()).toBe(1);
    await endRun(server, run);
  },
);

journey(
  "the log follows at its end only, and stays where it is while another panel is in front",
  HERE,
  async ({ app, server }) => {
    const run = await begin(app, server);
    const { sheet } = app;
    const follow = sheet.getByRole("checkbox", { name: "Follow", exact: true });
    const place = () => log(app).evaluate((rows) => rows.scrollTop);
    const wheel = async (by: number) => {
      await log(app).hover();
      await sheet.mouse.wheel(0, by);
    };
    await expect.poll(place).toBeGreaterThan(200);
    await wheel(-100);
    await expect.poll(() => follow.isChecked()).toBe(false);
    const here = await place();
    await app.panel("Problems");
    await app.panel("Log");
    await expect.poll(place).toBe(here);
    // Lines come while one scrolls: who wants the end scrolls on until it is there.
    const scrollOn = async () => {
      await wheel(100_000);
      return follow.isChecked();
    };
    await expect.poll(scrollOn).toBe(true);
    await expect.poll(place).toBeGreaterThan(here + 200);
    await endRun(server, run);
  },
);

journey(
  "a line of the log leads to its state and its moment; what came later is dimmed",
  HERE,
  async ({ app, server }) => {
    const run = await begin(app, server);
    const { sheet } = app;
    await sheet.getByLabel("Filter the log").fill("e");
    const line = log(app).getByText("the wheel sticks");
    await line.click();
    await app.selected(`state:${await app.path("Turn")}`);
    expect(await momentOf(app)).toBe(null);
    await sheet.getByRole("button", { name: "Show this moment" }).click();
    await app.until(({ tab }) => tab?.run.value?.playhead.value != null, null);
    const playhead = await momentShown(app);
    const active = await sheet.evaluate(
      () =>
        window.__rafcon.page.active.value?.run.value?.playheadSnapshot.value?.picture.active.map(
          ({ path }) => path,
        ) ?? [],
    );
    expect(active).toContain(await app.path("Turn"));
    await log(app).locator(".log-here", { hasText: "the wheel sticks" }).waitFor();
    await log(app).locator(".log-later", { hasText: "KeyError" }).first().waitFor();
    expect(await log(app).locator(".log-later", { hasText: "hello" }).count()).toBe(0);
    await log(app).getByText("hello").dblclick();
    await app.until(({ tab }, before) => {
      const now = tab?.run.value?.playhead.value;
      return now != null && before !== null && now < before;
    }, playhead);
    await endRun(server, run);
  },
);

journey(
  "a traceback is folded, and leads to the line of one's own script",
  HERE,
  async ({ app, server }) => {
    const run = await begin(app, server);
    const { sheet } = app;
    await sheet.getByLabel("Level", { exact: true }).selectOption("error");
    await log(app).getByText("KeyError: 'out' — script.py line 3").first().click();
    const chosen = sheet.getByRole("region", { name: "Selected line" });
    await chosen.getByText('return way["out"]').first().waitFor();
    await chosen.getByText("Full traceback").waitFor();
    expect(await chosen.locator("details").getAttribute("open")).toBe(null);
    await chosen.getByRole("button", { name: "Copy" }).click();
    await expect.poll(() => app.copied()).toContain("Traceback");
    await chosen.getByRole("button", { name: "script.py line 3" }).click();
    await app.selected(`state:${await app.path("Find the way")}`);
    const editor = sheet.locator(".cm-activeLine", { hasText: 'return way["out"]' });
    await editor.waitFor();
    await endRun(server, run);
  },
);

async function momentOf(app: App): Promise<number | null> {
  return app.sheet.evaluate(
    () => window.__rafcon.page.active.value?.run.value?.playhead.value ?? null,
  );
}
