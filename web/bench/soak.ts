/** Watches a mission that does not end, for long: `cargo xtask soak-web`. Memory of the page, every event once, frames. Prints a
 * table, or with `--json` one JSON object a line; fails if something was lost or memory grew. */

import type { Page as Sheet } from "playwright-core";
import { lookAround } from "./gestures.ts";
import { whileShown } from "./live.ts";
import { growth, type Sample, sampled } from "./memory.ts";
import { compared, theJournal, thePage } from "./once.ts";
import { asked, printed, type Wanted } from "./soak_figures.ts";
import { type BenchSetup, begin, end, freshPage } from "./support.ts";
import { median, presentedIntervals, quantile, scriptingPerFrame, traced } from "./trace.ts";

/** What grows in the beginning may: this time is not compared, or a third of a short one. */
const WARM_UP_MS = 60_000;

/** Every so many samples somebody looks around. */
const LOOK_EVERY = 3;

async function main(wanted: Wanted): Promise<void> {
  const setup = await begin(["endless_750"], wanted.rate);
  try {
    await watched(setup, wanted);
  } finally {
    await end(setup);
  }
}

async function watched(setup: BenchSetup, wanted: Wanted): Promise<void> {
  const sheet = await freshPage(setup);
  const machine = "endless_750";
  const found = await whileShown(sheet, setup.server, machine, async (run) => {
    const samples = await overTime(setup, sheet, wanted);
    const session = await sheet.context().newCDPSession(sheet);
    const events = await traced(session, () => lookAround(sheet));
    return { run, samples, events };
  });
  const journal = await theJournal(setup.server, found.run);
  const received = await thePage(sheet, journal.at(-1)?.sequence ?? 0);
  const differences = compared(received, journal);
  for (const text of differences.slice(0, 10)) process.stderr.write(`${text}\n`);
  const warm = found.samples.filter(({ at_ms }) => at_ms >= warmUp(wanted));
  const [scripting, presented] = [
    scriptingPerFrame(found.events),
    presentedIntervals(found.events),
  ];
  const isFine = printed(wanted, {
    events: journal.length,
    events_per_second: journal.length / ((journal.at(-1)?.t_ns ?? 0) / 1e9),
    differences: differences.length,
    page_growth_percent: growth(warm.map(({ page }) => page)),
    browser_growth_percent: growth(warm.map(({ browser }) => browser)),
    page_mb: (warm.at(-1)?.page ?? Number.NaN) / 2 ** 20,
    browser_mb: (warm.at(-1)?.browser ?? Number.NaN) / 2 ** 20,
    frame_median_ms: median(scripting),
    frame_p95_ms: quantile(scripting, 0.95),
    presented_median_ms: median(presented),
  });
  if (!isFine) process.exitCode = 1;
}

function warmUp({ seconds }: Wanted): number {
  return Math.min(WARM_UP_MS, (seconds * 1_000) / 3);
}

/** The memory again and again, as long as it is wanted; now and then somebody looks around. */
async function overTime(
  setup: BenchSetup,
  sheet: Sheet,
  wanted: Wanted,
): Promise<readonly Sample[]> {
  const samples: Sample[] = [];
  const begun = performance.now();
  const since = () => performance.now() - begun;
  while (since() < wanted.seconds * 1_000) {
    const next = since() + wanted.every * 1_000;
    if (samples.length % LOOK_EVERY === 1) await lookAround(sheet);
    await sheet.waitForTimeout(Math.max(0, next - since()));
    const sample = await sampled(setup.browser, sheet, since());
    samples.push(sample);
    const mb = (bytes: number) => (bytes / 2 ** 20).toFixed(1).padStart(7);
    const seconds = Math.round(sample.at_ms / 1_000);
    process.stderr.write(
      `${seconds} s: page ${mb(sample.page)} MB, browser ${mb(sample.browser)} MB\n`,
    );
  }
  return samples;
}

await main(asked(process.argv.slice(2)));
