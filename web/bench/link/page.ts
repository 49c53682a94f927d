/** A page of a station in a real browser: how long it takes to show the run as it is. */

import type { Browser } from "playwright-core";
import type { RunNow } from "../../src/model/generated/protocol.ts";
import type { Host } from "./host.ts";

/** A first visit, without a cache: the ms from the address to a drawn picture that is not older than the visit itself. */
export async function pageLive(browser: Browser, host: Host, run: string): Promise<number> {
  const context = await browser.newContext({ viewport: { width: 1_600, height: 1_000 } });
  await context.addInitScript("window.__rafcon = null");
  const sheet = await context.newPage();
  const { snapshot } = await host.ask<RunNow>("GET", `/runs/${run}`);
  const begun = performance.now();
  await sheet.goto(`${host.link}&layout=mission&run=${run}`, { waitUntil: "commit" });
  await sheet.waitForFunction(
    ([id, sequence]) => {
      const shown = window.__rafcon?.page.active.value?.run.value;
      return shown?.id === id && (shown.now.value?.snapshot?.sequence ?? 0) >= sequence;
    },
    [run, snapshot?.sequence ?? 0] as const,
    { timeout: 300_000, polling: 20 },
  );
  await sheet.evaluate(
    () =>
      new Promise<void>((done) => requestAnimationFrame(() => requestAnimationFrame(() => done()))),
  );
  const took = performance.now() - begun;
  await context.close();
  return took;
}
