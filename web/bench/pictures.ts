/** Takes the pictures of the page that stand in the documents: `cargo xtask pictures`. The mission at five depths, one state of it
 * in the editor, and a run of it, in both themes. */

import { mkdirSync } from "node:fs";
import { join } from "node:path";
import type { Page as Sheet } from "playwright-core";
import { REPOSITORY } from "../e2e/support/places.ts";
import { ofRun, runBefore } from "./run_pictures.ts";
import { settled } from "./settled.ts";
import { type BenchSetup, begin, end, freshPage, open } from "./support.ts";

const DEPTHS = 5;
const FOLDER = join(REPOSITORY, "docs", "pictures");

async function main(): Promise<void> {
  mkdirSync(FOLDER, { recursive: true });
  const setup = await begin(["mission_750", "rover_750"]);
  try {
    await runBefore(setup);
    for (const theme of ["light", "dark"] as const) {
      await taken(setup, theme);
      await ofRun(setup, theme, take);
    }
  } finally {
    await end(setup);
  }
}

function take(sheet: Sheet, name: string): Promise<unknown> {
  return sheet.screenshot({ path: join(FOLDER, `${name}.png`) });
}

async function taken(setup: BenchSetup, theme: "light" | "dark"): Promise<void> {
  const sheet = await freshPage(setup, { colorScheme: theme, reducedMotion: "reduce" });
  await open(sheet, "mission_750");
  await sheet.evaluate(() => document.fonts.ready.then(() => undefined));
  for (let depth = 1; depth <= DEPTHS; depth++) {
    await lookInto(sheet, depth);
    await take(sheet, `mission-${depth}-${theme}`);
  }
  await lookAtWork(sheet);
  await take(sheet, `editor-${theme}`);
  await sheet.context().close();
}

/** Looks at a part of the mission with one of its states selected. */
async function lookAtWork(sheet: Sheet): Promise<void> {
  await sheet.evaluate(() => {
    const { tab, canvas } = window.__rafcon.context();
    if (!tab || !canvas) return;
    const { machine } = tab.session;
    const part = [...machine.paths()].find(
      (path) => machine.state(path)?.name === "Fetch the battery",
    );
    if (part === undefined) return;
    const scripted = machine
      .children(part)
      .find((path) => machine.state(path)?.kind === "execution");
    tab.view.selection.value = new Set(scripted ? [`state:${scripted}`] : []);
    canvas.fit([part]);
  });
  await settled(sheet);
}

/** Looks at one of the states on the way to the deepest one: the first time at the root, the last time at its container. */
async function lookInto(sheet: Sheet, depth: number): Promise<void> {
  await sheet.evaluate(
    ([number, count]) => {
      const { tab, canvas } = window.__rafcon.context();
      const paths = [...(tab?.session.machine.paths() ?? [])].map((path) => path.split("/"));
      const deepest = paths.reduce((one, other) => (other.length > one.length ? other : one), []);
      const levels = Math.max(1, deepest.length - 1);
      const level = 1 + Math.round(((levels - 1) * (number - 1)) / (count - 1));
      canvas?.fit([deepest.slice(0, level).join("/")]);
    },
    [depth, DEPTHS] as const,
  );
  await settled(sheet);
}

await main();
