/** Takes pictures of one run of the mission: while it goes on, in mission control with a question that waits, and afterwards at the
 * moment at which something went wrong. */

import type { Page as Sheet } from "playwright-core";
import type { ElementKey } from "../src/model/element.ts";
import { ASKER, SLOW } from "./posing.ts";
import { settled } from "./settled.ts";
import { type BenchSetup, freshPage, open } from "./support.ts";

const MACHINE = "rover_750";
/** Seconds that a simulated second takes: twice as many as by itself, so that there is time to look. */
const TIME_SCALE = 0.12;
/** So long the values of what just began may be on their way. */
const VALUES_MS = 2_000;
/** So long lines may look for their ways while a run goes on. */
const ROUTES_MS = 5_000;
/** It ends by aborted, and its container goes on by another way. */
const FAILED = [
  "Explore",
  "Survey",
  "Sector 3",
  "Visit the waypoints",
  "Waypoint 17",
  "Drive there",
  "Follow the path",
];

export type Take = (sheet: Sheet, name: string) => Promise<unknown>;

/** Runs the mission once before, so that it is known how long things usually take. */
export async function runBefore(setup: BenchSetup): Promise<void> {
  const sheet = await freshPage(setup);
  await open(sheet, MACHINE);
  await begun(sheet);
  await answered(sheet);
  await untilOver(sheet);
  await sheet.context().close();
}

/** The pictures in the theme of a fresh page. */
export async function ofRun(setup: BenchSetup, theme: "light" | "dark", take: Take): Promise<void> {
  const sheet = await freshPage(setup, { colorScheme: theme, reducedMotion: "reduce" });
  await sheet.evaluate(() => document.fonts.ready.then(() => undefined));
  await open(sheet, MACHINE);
  await laidOut(sheet, "Debug");
  await lookAt(sheet, SLOW.slice(0, -1), SLOW);
  await begun(sheet);
  await untilActive(sheet, SLOW);
  await settled(sheet, VALUES_MS);
  await withoutNotices(sheet);
  await take(sheet, `live-${theme}`);
  await toMissionControl(sheet);
  await asked(sheet);
  await settled(sheet, ROUTES_MS);
  await withoutNotices(sheet);
  await take(sheet, `mission-control-${theme}`);
  await answered(sheet);
  await untilOver(sheet);
  await laidOut(sheet, "Debug");
  await lookAt(sheet, FAILED.slice(0, -2), FAILED);
  await showEnd(sheet, FAILED);
  await settled(sheet);
  await withoutNotices(sheet);
  await take(sheet, `replay-${theme}`);
  await sheet.context().close();
}

/** Starts a run of the machine in front; the page shows it from then on. */
async function begun(sheet: Sheet): Promise<void> {
  await sheet.evaluate(
    async ([path, scale]) => {
      const { page } = window.__rafcon;
      const project = page.projects.value[0]?.id ?? "";
      const machine = { project, path };
      const run = await page.runs.start({ machine, inputs: { time_scale: scale } });
      await page.showRun(run);
    },
    [MACHINE, TIME_SCALE] as const,
  );
}

async function laidOut(sheet: Sheet, layout: string): Promise<void> {
  await sheet.evaluate((name) => window.__rafcon.context().shell.layouts.apply(name), layout);
  await settled(sheet);
}

/** Looks at one state with another one selected; both by the names from the root on. */
async function lookAt(
  sheet: Sheet,
  whole: readonly string[],
  selected: readonly string[],
): Promise<void> {
  const [there, chosen] = [await pathOf(sheet, whole), await pathOf(sheet, selected)];
  await sheet.evaluate(
    ([place, key]) => {
      const { tab, canvas } = window.__rafcon.context();
      if (tab) tab.view.selection.value = new Set([key]);
      canvas?.fit([place]);
    },
    [there, `state:${chosen}` satisfies ElementKey] as const,
  );
  await settled(sheet);
}

async function untilActive(sheet: Sheet, names: readonly string[]): Promise<void> {
  const path = await pathOf(sheet, names);
  await sheet.waitForFunction(
    (wanted) => {
      const active = window.__rafcon.page.active.value?.run.value?.now.value?.snapshot?.active;
      return active?.filter(({ path }) => path.startsWith(`${wanted}/`)).length === 2;
    },
    path,
    { timeout: 0 },
  );
}

/** With nothing selected, so that the whole machine stands beside it. */
async function toMissionControl(sheet: Sheet): Promise<void> {
  await sheet.evaluate(() => {
    const { commands, context } = window.__rafcon;
    const { tab } = context();
    if (tab) tab.view.selection.value = new Set();
    commands.run("mission.open", context());
  });
}

/** What was told meanwhile lies over what is to be seen. */
async function withoutNotices(sheet: Sheet): Promise<void> {
  await sheet.evaluate(() => {
    const closing = document.querySelectorAll<HTMLElement>('[aria-label="Close notice"]');
    for (const button of closing) button.click();
  });
}

async function asked(sheet: Sheet): Promise<void> {
  await sheet.getByRole("form").getByRole("button", { name: ASKER }).waitFor({ timeout: 0 });
}

/** Answers in mission control, once there is something to answer. */
async function answered(sheet: Sheet): Promise<void> {
  await toMissionControl(sheet);
  await asked(sheet);
  await sheet.getByRole("form").getByRole("button", { name: ASKER }).click();
}

async function untilOver(sheet: Sheet): Promise<void> {
  await sheet.waitForFunction(
    () => window.__rafcon.page.active.value?.run.value?.now.value?.run.phase === "finished",
    null,
    { timeout: 0 },
  );
}

/** Shows the moment at which the state ended first. */
async function showEnd(sheet: Sheet, names: readonly string[]): Promise<void> {
  const path = await pathOf(sheet, names);
  await sheet.waitForFunction((wanted) => {
    const watch = window.__rafcon.page.active.value?.run.value;
    if (!watch?.isCaughtUp.value) return false;
    const { journal, playhead } = watch;
    for (let index = 0; index < journal.length; index += 1) {
      if (journal.outcome(index) && journal.pathOf(journal.pathNumber(index)) === wanted) {
        playhead.value = journal.sequence(index);
        return true;
      }
    }
    return false;
  }, path);
  await sheet.waitForFunction(() => {
    const watch = window.__rafcon.page.active.value?.run.value;
    return watch?.playheadSnapshot.value?.picture.sequence === watch?.playhead.value;
  });
}

/** The path of a state by the names from the root on. */
function pathOf(sheet: Sheet, names: readonly string[]): Promise<string> {
  return sheet.evaluate((wanted) => {
    const machine = window.__rafcon.context().tab?.session.machine;
    const root = machine ? [...machine.paths()][0]?.split("/")[0] : undefined;
    if (!machine || root === undefined) throw new Error("no machine is open");
    return wanted.reduce((around, name) => {
      const found = machine.children(around).find((path) => machine.state(path)?.name === name);
      if (found === undefined) throw new Error(`there is no state ${name} in ${around}`);
      return found;
    }, root);
  }, names);
}
