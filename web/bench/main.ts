/** Measures the page: `cargo xtask bench-web`. Prints a table, or with `--json` one JSON object a line. */

import type { CDPSession, Page as Sheet } from "playwright-core";
import { editToPicture, memoryGrowth, undoAndRedo } from "./edits.ts";
import { asLines, asTable, type Figures } from "./figures.ts";
import { lookAround } from "./gestures.ts";
import { notedAges, whileShown } from "./live.ts";
import { type BenchSetup, begin, end, forget, freshPage, open, type Size } from "./support.ts";
import { tenMillion } from "./ten_million.ts";
import { median, presentedIntervals, quantile, scriptingPerFrame, traced } from "./trace.ts";

/** How often a machine is opened; the middle one counts. */
const OPENINGS = 3;

interface Frames {
  readonly scripting: readonly number[];
  readonly presented: readonly number[];
}

async function main(json: boolean): Promise<void> {
  const setup = await begin(["mission_750", "endless_750", "large_10000"]);
  try {
    const figures = await measured(setup);
    process.stdout.write(json ? asLines(figures) : asTable(figures));
  } finally {
    await end(setup);
  }
}

async function measured(setup: BenchSetup): Promise<Figures> {
  const small = await frames(setup, "mission_750");
  const large = await frames(setup, "large_10000");
  const open_750_ms = await opening(setup, "mission_750");
  const open_10000_ms = await opening(setup, "large_10000");
  const edits = await edited(setup);
  const back = await takenBack(setup);
  const shown = await live(setup);
  const long = await tenMillion(setup);
  return {
    frame_750_median_ms: median(small.scripting),
    frame_750_p95_ms: quantile(small.scripting, 0.95),
    frame_10000_median_ms: median(large.scripting),
    frame_10000_p95_ms: quantile(large.scripting, 0.95),
    open_750_ms,
    open_10000_ms,
    edit_to_picture_ms: edits.picture_ms,
    undo_10000_ms: back.undo,
    redo_10000_ms: back.redo,
    presented_750_median_ms: median(small.presented),
    presented_10000_median_ms: median(large.presented),
    memory_growth_percent: edits.growth_percent,
    live_1000_frame_median_ms: median(shown.scripting),
    live_1000_frame_p95_ms: quantile(shown.scripting, 0.95),
    live_1000_presented_median_ms: median(shown.presented),
    live_1000_age_ms: median(shown.ages),
    ten_million_open_s: long.open_s,
    ten_million_page_mb: long.page_mb,
  };
}

/** Looks around in a machine with all data flows shown, once to warm up and once to be measured. */
async function frames(setup: BenchSetup, size: Size): Promise<Frames> {
  const sheet = await freshPage(setup);
  await open(sheet, size);
  await showAllFlows(sheet);
  await lookAround(sheet);
  const session = await sheet.context().newCDPSession(sheet);
  const events = await traced(session, () => lookAround(sheet));
  await forget(sheet, setup.server);
  const found = { scripting: scriptingPerFrame(events), presented: presentedIntervals(events) };
  const counts = `${found.scripting.length} frames drawn, ${found.presented.length} shown`;
  process.stderr.write(`${size}: ${counts}\n`);
  return found;
}

async function showAllFlows(sheet: Sheet): Promise<void> {
  await sheet.evaluate(() => {
    const view = window.__rafcon.context().tab?.view;
    if (view) view.modes.value = { ...view.modes.value, dataFlows: "all" };
  });
}

/** Looks around in a mission while it runs, and says how old what is painted was meanwhile. */
async function live(setup: BenchSetup): Promise<Frames & { readonly ages: readonly number[] }> {
  const sheet = await freshPage(setup);
  const found = await whileShown(sheet, setup.server, "endless_750", async () => {
    await lookAround(sheet);
    const session = await sheet.context().newCDPSession(sheet);
    const ages = await notedAges(sheet);
    const before = await eventCount(sheet);
    const events = await traced(session, () => lookAround(sheet));
    const after = await eventCount(sheet);
    const rate = Math.round(((after.events - before.events) / (after.at - before.at)) * 1_000);
    process.stderr.write(`endless_750: ${rate} events a second\n`);
    const [scripting, presented] = [scriptingPerFrame(events), presentedIntervals(events)];
    return { scripting, presented, ages: await ages() };
  });
  await forget(sheet, setup.server);
  return found;
}

/** How many events the page was told, and when. */
function eventCount(sheet: Sheet): Promise<{ readonly events: number; readonly at: number }> {
  return sheet.evaluate(() => ({
    events: window.__rafcon.page.active.value?.run.value?.journal.length ?? 0,
    at: performance.now(),
  }));
}

async function opening(setup: BenchSetup, size: Size): Promise<number> {
  const times: number[] = [];
  for (let time = 0; time < OPENINGS; time++) {
    const sheet = await freshPage(setup);
    times.push(await open(sheet, size));
    await forget(sheet, setup.server);
  }
  return median(times);
}

async function edited(setup: BenchSetup) {
  const sheet = await freshPage(setup);
  await open(sheet, "mission_750");
  const session: CDPSession = await sheet.context().newCDPSession(sheet);
  const picture_ms = await editToPicture(sheet);
  const growth_percent = await memoryGrowth(sheet, session);
  await forget(sheet, setup.server);
  return { picture_ms, growth_percent };
}

/** How long undo and redo take in a large machine. */
async function takenBack(setup: BenchSetup): Promise<{ undo: number; redo: number }> {
  const sheet = await freshPage(setup);
  await open(sheet, "large_10000");
  const found = await undoAndRedo(sheet);
  await forget(sheet, setup.server);
  return found;
}

await main(process.argv.includes("--json"));
