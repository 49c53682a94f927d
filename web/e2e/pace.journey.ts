/** How soon one sees what another does. Both pages are in one process and are watched by one clock, frame by frame. */

import type { Page as Sheet } from "playwright-core";
import { expect } from "vitest";
import type { ElementKey } from "../src/model/element.ts";
import { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";

const FULL = "PACKER/ISFULL";
const LABEL = "PACKER/LABELS";
const TIMES = 9;

interface Pace {
  readonly frames: number;
  readonly ms: number;
}

/** Opens the page a second time, from the page itself. */
async function beside(app: App, machine: string): Promise<App> {
  const coming = app.sheet.waitForEvent("popup");
  await app.sheet.evaluate(() => void window.open(location.href));
  const other = new App(await coming, app.server);
  await other.connected();
  await other.open(machine);
  return other;
}

/** What is done in the opener: a state is selected, by its path, or the root gets so many children. */
type Deed = { readonly selected: string } | { readonly children: number };

/** From the frame in which the opener shows the deed to the one in which this page shows it too. */
function seen(sheet: Sheet, deed: Deed): Promise<Pace> {
  return sheet.evaluate(
    (wanted) =>
      new Promise<Pace>((done) => {
        const theirs = (window.opener as Window).__rafcon.context().tab;
        const mine = window.__rafcon.context().tab;
        const hasCount = (tab: typeof mine) =>
          "children" in wanted &&
          tab?.session.machine.children(tab.session.machine.root).length === wanted.children;
        const isDone = () =>
          "selected" in wanted
            ? theirs?.view.selection.value.has(`state:${wanted.selected}` as ElementKey)
            : hasCount(theirs);
        const isSeen = () =>
          "selected" in wanted
            ? mine?.session.people.value.some(({ selection }) =>
                selection.includes(wanted.selected),
              )
            : hasCount(mine);
        let begun: number | null = null;
        let frames = 0;
        const look = (now: number) => {
          if (begun !== null) frames++;
          else if (isDone()) begun = now;
          if (begun !== null && isSeen()) done({ frames, ms: now - begun });
          else requestAnimationFrame(look);
        };
        requestAnimationFrame(look);
      }),
    deed,
  );
}

/** Each was seen; the middle one is printed, for a figure that depends on the machine has no bar here. */
function judge(found: readonly Pace[]): void {
  const sorted = [...found].sort((one, other) => one.frames - other.frames);
  const { frames, ms } = sorted[sorted.length >> 1] ?? { frames: Infinity, ms: Infinity };
  process.stdout.write(`seen after ${frames} frames, ${ms.toFixed(0)} ms\n`);
  expect(found).toHaveLength(TIMES);
}

journey("a selection is seen by the other", { open: "hierarchy_and_data" }, async ({ app }) => {
  const other = await beside(app, "hierarchy_and_data");
  const found: Pace[] = [];
  for (let time = 0; time < TIMES; time++) {
    const path = time % 2 === 0 ? LABEL : FULL;
    const there = seen(other.sheet, { selected: path });
    await app.select(path);
    found.push(await there);
  }
  judge(found);
});

journey("an edit is seen by the other", { open: "hierarchy_and_data" }, async ({ app }) => {
  const other = await beside(app, "hierarchy_and_data");
  const found: Pace[] = [];
  for (let time = 0; time < TIMES; time++) {
    const isMore = time % 2 === 0;
    if (isMore) await app.select(FULL);
    const there = seen(other.sheet, { children: isMore ? 4 : 3 });
    await app.press(isMore ? "Control+d" : "Control+z");
    found.push(await there);
    await app.settled();
  }
  judge(found);
});
