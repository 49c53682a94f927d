/** A run of ten million events in the page: how soon it is there, and how much memory it takes while one looks around in it. */

import type { Page as Sheet } from "playwright-core";
import { FAST_PACKER, longRun } from "../e2e/support/long_run.ts";
import { newPlace } from "../e2e/support/places.ts";
import { Server } from "../e2e/support/server.ts";
import type { Statistics } from "../src/model/generated/protocol.ts";
import { sampled } from "./memory.ts";
import type { BenchSetup } from "./support.ts";
import { freshPage } from "./support.ts";

const EVENTS = 10_000_000;
/** So often it is looked at from afar and from near. */
const ROUNDS = 12;

interface TenMillion {
  /** From the wish to see it until status, time line and newest history are there, at a server that has never read it. */
  readonly open_s: number;
  /** The most that page and array buffers took after garbage was collected. */
  readonly page_mb: number;
}

export async function tenMillion({ browser }: BenchSetup, events = EVENTS): Promise<TenMillion> {
  const server = await Server.start(newPlace({ packer_750: FAST_PACKER }));
  try {
    const run = await longRun(server, "packer_750", events);
    const setup = { server, browser };
    // Afresh: this server knows nothing of the run.
    await server.end();
    await server.restart();
    const sheet = await freshPage(setup);
    await sheet.evaluate(() => {
      const { commands, context, page } = window.__rafcon;
      commands.run("view.panel", context(), "history");
      return page.runs.refresh();
    });
    const open_s = (await opened(sheet, run)) / 1_000;
    const page_mb = await lookedAround(setup, sheet);
    const counted = await server.ask<Statistics>("GET", `/runs/${run}/statistics`);
    process.stderr.write(`ten million: ${counted.sequence} events, open after ${open_s} s\n`);
    await sheet.context().close();
    return { open_s, page_mb };
  } finally {
    await server.dispose();
  }
}

/** The ms until the run's status, its newest history and the whole of its time line are there. */
function opened(sheet: Sheet, run: string): Promise<number> {
  return sheet.evaluate(
    (id) =>
      new Promise<number>((done) => {
        const { page, commands, context } = window.__rafcon;
        const begun = performance.now();
        let isListed = false;
        const look = () => {
          const watch = page.active.value?.run.value;
          const isThere = watch?.now.value?.run.phase === "finished" && watch.isCaughtUp.value;
          const isDrawn = document.querySelector(".timeline-rows[data-drawn='whole']") !== null;
          const rows = document.querySelectorAll(".history-rows [role='treeitem']").length;
          if (isThere && rows > 1 && !isListed) {
            isListed = true;
            commands.run("view.panel", context(), "timeline");
          }
          if (isListed && isDrawn) {
            requestAnimationFrame(() => done(performance.now() - begun));
          } else requestAnimationFrame(look);
        };
        void page.showRun(id);
        look();
      }),
    run,
  );
}

/** Zooms in and out at moments all over the run, goes there, scrolls the history; the most memory in between, in MB. */
async function lookedAround({ browser }: BenchSetup, sheet: Sheet): Promise<number> {
  const canvas = sheet.locator(".timeline-canvas");
  const box = await canvas.boundingBox();
  if (!box) throw new Error("the time line has no size");
  let most = 0;
  for (let round = 0; round < ROUNDS; round += 1) {
    const x = box.x + (box.width * (round + 0.5)) / ROUNDS;
    await sheet.mouse.move(x, box.y + 10);
    await sheet.mouse.click(x, box.y + 10);
    for (let step = 0; step < 30; step += 1) await sheet.mouse.wheel(0, step < 20 ? -400 : 400);
    await sheet.keyboard.press("ArrowLeft");
    await sheet.keyboard.press("f");
    await sheet.waitForTimeout(300);
    most = Math.max(most, (await sampled(browser, sheet, 0)).whole);
  }
  return most / 1e6;
}
