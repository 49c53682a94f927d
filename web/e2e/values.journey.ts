/** Values of a run as people look at them: structured, at a moment, as they change, over time, and counted. */

import { execFileSync } from "node:child_process";
import { join } from "node:path";
import type { Locator } from "playwright-core";
import { expect } from "vitest";
import type { RunSummary } from "../src/model/generated/protocol.ts";
import { measured } from "../src/panels/parts/duration.ts";
import type { App } from "./support/app.ts";
import { type Hands, journey } from "./support/journey.ts";
import { machinePixels } from "./support/pixels.ts";
import { binary } from "./support/places.ts";
import { ended, perform, stopRun } from "./support/runs.ts";
import { sensing } from "./support/values.ts";

const LOOK = "SENSES/LOOKIN";
const GRASP = "SENSES/GRASPS";

const withRounds = (rounds: number) => ({
  machines: { sensing: sensing({ rounds, pause_s: 0 }) },
  open: "sensing",
});

/** Starts a run of the machine and shows it in its tab. */
async function run({ app, server }: Hands): Promise<string> {
  const machine = { project: "missions", path: "sensing" };
  const start = {
    id: "values",
    machine,
    inputs: {},
    start_from: null,
    keeping: "full",
    strict: false,
    hold: false,
    breakpoints: [],
    on_crash: null,
    size_max: null,
  };
  const { id } = await server.ask<RunSummary>("POST", "/runs", start);
  await app.sheet.evaluate(async (of) => {
    await window.__rafcon.page.showRun(of);
  }, id);
  return id;
}

/** The part of the inspector about the run. */
function inRun(app: App, group: "Inputs" | "Outputs") {
  return app.sheet.getByRole("region", { name: new RegExp(`^${group}\\b.* in the run$`) });
}

function value(app: App, group: "Inputs" | "Outputs", name: string, shown: string) {
  const row = inRun(app, group).locator(".value-row", { hasText: new RegExp(`^${name}`) });
  return row.locator(".value-short", { hasText: shown });
}

journey(
  "a nested dict and an array are opened, at the end and at a moment",
  withRounds(6),
  async (hands) => {
    const { app } = hands;
    await run(hands);
    await ended(app, "aborted");
    await app.select(LOOK);
    await value(app, "Outputs", "count", "6").waitFor();
    const outputs = inRun(app, "Outputs");
    await outputs.getByRole("button", { name: /^pose:/ }).click();
    await outputs.getByRole("button", { name: /^position:/ }).click();
    await value(app, "Outputs", "0", "6").waitFor();

    await outputs.getByRole("button", { name: /^ranges:/ }).click();
    await outputs.getByText("of float64, 500; showing one in 2").waitFor();
    await outputs.getByRole("img", { name: "ranges: 250 numbers from 0 to 2988" }).waitFor();
    await outputs.getByRole("group", { name: "Show ranges as" }).getByText("Table").click();
    await outputs.getByRole("row", { name: "498 2988" }).waitFor();

    await outputs.getByRole("button", { name: "Copy pose as Python" }).click();
    await expect
      .poll(() => app.copied())
      .toBe('{"frame": "map", "joints": {"elbow": 1.5}, "position": [6, 2.5, -1]}');

    await inRun(app, "Inputs")
      .getByRole("button", { name: "Show the moment when count was set" })
      .click();
    await app.until(({ tab }) => (tab?.run.value?.playhead.value ?? null) !== null, null);
    await app.sheet.getByText("Outputs at its last end").waitFor();
    await value(app, "Outputs", "count", "5").waitFor();
    await value(app, "Outputs", "0", "5").waitFor();
  },
);

journey(
  "values of a run in progress change where they are open",
  { machines: { sensing: sensing({ rounds: 3_000, pause_s: 0.05 }) }, open: "sensing" },
  async (hands) => {
    const { app } = hands;
    await run(hands);
    await app.select(LOOK);
    const outputs = inRun(app, "Outputs");
    const pose = outputs.getByRole("button", { name: /^pose:/ });
    await pose.hover();
    expect(await pose.locator(":scope > :hover").count()).toBe(0);
    await pose.click();
    await outputs.getByRole("button", { name: /^position:/ }).click();
    const first = outputs.locator(".value-inside .value-inside .value-short").first();
    const before = Number(await first.textContent());
    await expect.poll(async () => Number(await first.textContent())).toBeGreaterThan(before);
    const then = Number(await first.textContent());
    await expect.poll(async () => Number(await first.textContent())).toBeGreaterThan(then);
    await stopRun(app);
  },
);

/** Slow enough that its values stand apart in a plot, however long the run then takes to end. */
const slow = { machines: { sensing: sensing({ rounds: 8, pause_s: 0.1 }) }, open: "sensing" };

journey("an expression is watched, plotted, and leads to its moments", slow, async (hands) => {
  const { app } = hands;
  await run(hands);
  await ended(app, "aborted");
  await app.select(LOOK);
  await inRun(app, "Outputs").getByRole("button", { name: "Watch pose" }).click();
  await app.sheet.getByRole("button", { name: "Show watches" }).click();
  const panel = app.sheet.getByRole("region", { name: "Watched values" });
  const field = panel.getByLabel("Watched expression of pose");
  await field.fill("value.speed");
  await field.press("Enter");
  await panel.getByText('there is no "speed"').waitFor();
  await field.fill("value.joints.");
  await panel.getByText("a name is missing after the point").waitFor();
  await field.fill("value.joints.elbow * 100");
  await field.press("Enter");
  const now = (number: string) =>
    panel.locator(".value-short", { hasText: new RegExp(`^${number}$`) }).waitFor();
  await now("200");
  await panel.getByRole("img", { name: "pose over time: 8 points" }).waitFor();

  await panel.getByRole("button", { name: "Show the previous value of pose" }).click();
  await panel.getByRole("button", { name: "Show the previous value of pose" }).click();
  await now("175");
  const moment = () =>
    app.sheet.evaluate(() => window.__rafcon.page.active.value?.run.value?.playhead.value ?? null);
  const before = await moment();
  const plot = await panel.locator(".u-over").boundingBox();
  if (!plot || before === null) throw new Error("there is no plot, or no moment is shown");
  await app.sheet.mouse.move(plot.x + 3, plot.y + 20);
  await app.click({ x: plot.x + 2, y: plot.y + 20 });
  await app.until(({ tab }, late) => (tab?.run.value?.playhead.value ?? late) < late, before);
  await now("25");

  await app.sheet.reload();
  await app.connected();
  await perform(app, "view.panel", "watches");
  await panel.getByLabel("Watched expression of pose").waitFor();
  expect(await panel.getByLabel("Watched expression of pose").inputValue()).toBe(
    "value.joints.elbow * 100",
  );
});

/** Moves what is dragged over the middle of a thing. */
async function over(app: App, thing: Locator): Promise<void> {
  const box = await thing.boundingBox();
  if (!box) throw new Error("there is nothing to drag it over");
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await app.sheet.mouse.move(x - 5, y, { steps: 4 });
  await app.sheet.mouse.move(x, y, { steps: 4 });
}

journey(
  "a value is dragged from the inspector to the watches, and is watched as the run continues",
  { machines: { sensing: sensing({ rounds: 3_000, pause_s: 0.05 }) }, open: "sensing" },
  async (hands) => {
    const { app } = hands;
    await app.command("Layout: Debug");
    await run(hands);
    await app.select(LOOK);
    await perform(app, "view.panel", "watches");
    const panel = app.sheet.getByRole("region", { name: "Watched values" });
    await panel.getByText("Nothing is watched").waitFor();
    await app.panel("Inspector");
    const line = inRun(app, "Outputs").locator(".in-run-value", { hasText: /^count/ });
    await line.hover();
    await app.sheet.mouse.down();
    const tab = app.sheet.getByRole("tab", { name: "Watches", exact: true });
    await over(app, tab);
    await panel.getByText("Nothing is watched").waitFor();
    await over(app, panel);
    await app.sheet.mouse.up();
    await panel.getByLabel("Watched expression of count").waitFor();
    const shown = async () => Number(await panel.locator(".value-short").first().textContent());
    await expect.poll(shown).toBeGreaterThan(0);
    const before = await shown();
    await expect.poll(shown).toBeGreaterThan(before);
    await stopRun(app);
  },
);

journey(
  "values stand at ports while they are shown, and differ from moment to moment",
  withRounds(6),
  async (hands) => {
    const { app } = hands;
    await run(hands);
    await ended(app, "aborted");
    await app.select(LOOK);
    const shows = async (on: boolean) => {
      await app.press("v");
      await app.until(({ tab }, wanted) => tab?.view.modes.value.values === wanted, on);
      await app.drawn();
    };
    const { x, y } = await app.port("SENSES", "scoped_variable", "count");
    const clip = { x: Math.round(x) - 60, y: Math.round(y) - 30, width: 120, height: 22 };
    const chip = () => machinePixels(app, clip);
    await value(app, "Outputs", "count", "6").waitFor();
    const none = await chip();
    await inRun(app, "Inputs")
      .getByRole("button", { name: "Show the moment when count was set" })
      .click();
    await expect.poll(chip).not.toBe(none);
    await value(app, "Outputs", "count", "5").waitFor();
    await app.drawn();
    const five = await chip();
    await shows(false);
    await expect.poll(chip).not.toBe(five);
    const bare = await chip();
    await shows(true);
    await expect.poll(chip).toBe(five);
    for (let event = 0; event < 2; event++) await app.press(",");
    await expect.poll(chip).not.toBe(five);
    expect(await chip()).not.toBe(bare);
  },
);

/** An event as the command line prints it. */
interface Line {
  readonly t_ns: number;
  readonly event: {
    readonly type: string;
    readonly path: string;
    readonly outcome?: { readonly name: string };
  };
}

journey("statistics are what the command line tells of the run", withRounds(12), async (hands) => {
  const { app, server } = hands;
  const id = await run(hands);
  await ended(app, "aborted");
  await perform(app, "view.panel", "statistics");
  const words = ["history", id, "--json", "--kind", "entered", "--kind", "left"];
  const runs = ["--runs", join(server.place.folder, "runs")];
  const lines = execFileSync(binary(), [...words, ...runs], { encoding: "utf8" })
    .trim()
    .split("\n");
  const entries = lines.map((line) => JSON.parse(line) as Line);
  const lengths = lengthsOf(entries, LOOK);
  expect(lengths).toHaveLength(12);
  const table = app.sheet.getByRole("grid", { name: "Statistics of the run" });
  const row = table.getByRole("row", { name: "Look" });
  await row.getByText("again 11, done 1").waitFor();
  const cells = await row.getByRole("gridcell").allTextContents();
  const total = lengths.reduce((all, each) => all + each, 0);
  const shown = [total, Math.min(...lengths), Math.max(...lengths)].map((ns) => measured(ns / 1e6));
  expect([cells[1], cells[2], cells[3], cells[6]]).toEqual(["12", ...shown]);

  await app.sheet.getByLabel("Filter states").fill("aborted grasp");
  await row.waitFor({ state: "detached" });
  await table.getByRole("row", { name: "Grasp" }).click();
  await app.selected(`state:${GRASP}`);
});

/** How long a state was active, each time. */
function lengthsOf(lines: readonly Line[], path: string): readonly number[] {
  const times = lines.filter(({ event }) => event.path === path).map(({ t_ns }) => t_ns);
  return times.flatMap((t_ns, index) => (index % 2 === 1 ? [t_ns - (times[index - 1] ?? 0)] : []));
}

journey("an error says where in the script it came up", withRounds(2), async (hands) => {
  const { app } = hands;
  await run(hands);
  await ended(app, "aborted");
  await app.select(GRASP);
  const error = app.sheet.getByRole("note", { name: "Error" });
  await error.getByText("ValueError: the cup is out of reach").waitFor();
  await error.getByText('raise ValueError("the cup is out of reach")').waitFor();
  await error.getByRole("button", { name: "Grasp, line 2" }).click();
  await app.sheet.locator(".cm-activeLine", { hasText: "raise ValueError" }).waitFor();
  await error.getByRole("button", { name: "Full traceback (2 frames)" }).click();
  await error.getByText("Traceback (most recent call last)").waitFor();
});
