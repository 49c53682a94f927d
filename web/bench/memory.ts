/** How much memory a page takes, and its browser: what is left after collecting garbage. */

import { readFileSync } from "node:fs";
import type { Browser, Page as Sheet } from "playwright-core";

export interface Sample {
  /** Since the beginning. */
  readonly at_ms: number;
  /** What the page's scripts hold, in bytes. */
  readonly page: number;
  /** The same with array buffers. */
  readonly whole: number;
  /** What all processes of the browser have of the computer's memory, in bytes. */
  readonly browser: number;
}

export async function sampled(browser: Browser, sheet: Sheet, at_ms: number): Promise<Sample> {
  const session = await sheet.context().newCDPSession(sheet);
  await session.send("HeapProfiler.enable");
  await session.send("HeapProfiler.collectGarbage");
  const { usedSize, backingStorageSize } = await session.send("Runtime.getHeapUsage");
  await session.detach();
  const whole = usedSize + backingStorageSize;
  return { at_ms, page: usedSize, whole, browser: await ofProcesses(browser) };
}

async function ofProcesses(browser: Browser): Promise<number> {
  const session = await browser.newBrowserCDPSession();
  const { processInfo } = await session.send("SystemInfo.getProcessInfo");
  await session.detach();
  return processInfo.reduce((sum, { id }) => sum + share(id), 0);
}

/** The process' own memory, and its share of what it has together with others. */
function share(pid: number): number {
  try {
    const text = readFileSync(`/proc/${pid}/smaps_rollup`, "utf8");
    return Number(/^Pss:\s+(\d+) kB/m.exec(text)?.[1] ?? 0) * 1_024;
  } catch {
    // It has just ended.
    return 0;
  }
}

/** By how many percent the last third of the values is above the first. */
export function growth(values: readonly number[]): number {
  const third = Math.max(1, Math.floor(values.length / 3));
  const middle = (part: readonly number[]) =>
    [...part].sort((one, other) => one - other)[Math.floor(part.length / 2)] ?? Number.NaN;
  return (middle(values.slice(-third)) / middle(values.slice(0, third)) - 1) * 100;
}
