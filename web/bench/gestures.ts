/** The way that hands take over a machine: in by the wheel, across by dragging, out again; by real events of mouse and wheel. */

import type { Page as Sheet } from "playwright-core";
import { VIEW } from "./support.ts";

/** How often each of them. */
const STEPS = 40;

/** Zooms in at three places, pans in each, and comes back. */
export async function lookAround(sheet: Sheet): Promise<void> {
  const { x, y, width, height } = await frame(sheet);
  for (const [right, down] of [
    [0.5, 0.5],
    [0.3, 0.35],
    [0.7, 0.6],
  ] as const) {
    const at = { x: x + width * right, y: y + height * down };
    await wheel(sheet, at, -120);
    await pan(sheet, at, { x: width * 0.2, y: height * 0.1 });
    await wheel(sheet, at, -120);
    await pan(sheet, at, { x: -width * 0.2, y: height * 0.15 });
    await wheel(sheet, at, 120);
    await wheel(sheet, at, 120);
  }
}

async function frame(sheet: Sheet) {
  const canvas = sheet.getByRole("application", { name: "State machine" });
  return (await canvas.boundingBox()) ?? { x: 0, y: 0, ...VIEW };
}

async function wheel(sheet: Sheet, at: { x: number; y: number }, by: number): Promise<void> {
  await sheet.mouse.move(at.x, at.y);
  for (let step = 0; step < STEPS / 4; step++) await sheet.mouse.wheel(0, by);
}

async function pan(
  sheet: Sheet,
  at: { x: number; y: number },
  by: { x: number; y: number },
): Promise<void> {
  await sheet.mouse.move(at.x, at.y);
  await sheet.mouse.down({ button: "middle" });
  await sheet.mouse.move(at.x + by.x, at.y + by.y, { steps: STEPS });
  await sheet.mouse.move(at.x, at.y, { steps: STEPS });
  await sheet.mouse.up({ button: "middle" });
}
