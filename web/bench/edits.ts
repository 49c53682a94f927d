/** How soon an edit shows, and what a thousand of them leave in memory. */

import type { CDPSession, Page as Sheet } from "playwright-core";
import { FRAME } from "./support.ts";
import { median } from "./trace.ts";

const EDITS = 30;
const WARM_UP = 100;
const MANY = 1_000;

/** The ms from an edit to the first picture with it, in the middle of many: without the way to the server. */
export async function editToPicture(sheet: Sheet): Promise<number> {
  const times: number[] = [];
  for (let turn = 0; turn < EDITS; turn++) times.push(await one(sheet, turn));
  return median(times);
}

/** Moves the first child of the root; from the call to the end of the next frame, which has it. */
function one(sheet: Sheet, turn: number): Promise<number> {
  return sheet.evaluate(
    ([step, frame]) =>
      new Promise<number>((done, failed) => {
        const session = window.__rafcon.context().tab?.session;
        const path = session?.machine.children(session.machine.root)[0];
        if (!session || path === undefined) throw new Error("no machine is open");
        const seen = new PerformanceObserver((list) => {
          const picture = list.getEntriesByName(frame).find(({ startTime }) => startTime >= begun);
          if (!picture) return;
          seen.disconnect();
          made.then(() => done(picture.startTime + picture.duration - begun), failed);
        });
        seen.observe({ type: "measure" });
        const position: [number, number] = [50 + (step % 7) * 10, 60];
        const begun = performance.now();
        const made = session.edit("Move", {
          edit: "set_position",
          path,
          element: "state",
          position,
        });
      }),
    [turn, FRAME] as const,
  );
}

/** The ms from an undo, and from a redo, to the picture after it: with the way to the server, in the middle of many. */
export async function undoAndRedo(sheet: Sheet): Promise<{ undo: number; redo: number }> {
  const times = await sheet.evaluate(async (count) => {
    const session = window.__rafcon.context().tab?.session;
    const path = session?.machine.children(session.machine.root)[0];
    if (!session || path === undefined) throw new Error("no machine is open");
    const timed = async (act: () => Promise<unknown>) => {
      const begun = performance.now();
      await act();
      await new Promise(requestAnimationFrame);
      return performance.now() - begun;
    };
    for (let turn = 0; turn < count; turn++) {
      const position: [number, number] = [50 + turn * 10, 60];
      await session.edit("Move", { edit: "set_position", path, element: "state", position });
    }
    const undo: number[] = [];
    const redo: number[] = [];
    for (let turn = 0; turn < count; turn++) undo.push(await timed(() => session.undo()));
    for (let turn = 0; turn < count; turn++) redo.push(await timed(() => session.redo()));
    return { undo, redo };
  }, EDITS);
  return { undo: median(times.undo), redo: median(times.redo) };
}

/** By how much the page's memory is larger, in percent, after a thousand edits that were all undone. */
export async function memoryGrowth(sheet: Sheet, session: CDPSession): Promise<number> {
  await session.send("Performance.enable");
  await editAndUndo(sheet, WARM_UP);
  const before = await heap(session);
  await editAndUndo(sheet, MANY);
  const after = await heap(session);
  process.stderr.write(`memory: ${megabytes(before)} MB before, ${megabytes(after)} MB after\n`);
  return (after / before - 1) * 100;
}

function megabytes(bytes: number): number {
  return Math.round(bytes / 104_857.6) / 10;
}

function editAndUndo(sheet: Sheet, times: number): Promise<void> {
  return sheet.evaluate(async (count) => {
    const session = window.__rafcon.context().tab?.session;
    const path = session?.machine.children(session.machine.root)[0];
    if (!session || path === undefined) throw new Error("no machine is open");
    for (let turn = 0; turn < count; turn++) {
      const position: [number, number] = [50 + (turn % 7) * 10, 60 + (turn % 5)];
      await session.edit("Move", { edit: "set_position", path, element: "state", position });
      await session.undo();
    }
  }, times);
}

/** What scripts hold after the garbage is gone. */
async function heap(session: CDPSession): Promise<number> {
  await session.send("HeapProfiler.collectGarbage");
  const { metrics } = await session.send("Performance.getMetrics");
  return metrics.find(({ name }) => name === "JSHeapUsedSize")?.value ?? Number.NaN;
}
