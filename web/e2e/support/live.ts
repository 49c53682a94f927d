/** What the canvas shows of a run, by its pixels: which colour of the theme stands around a state. */

import { vi } from "vitest";
import type { Box } from "../../src/model/geometry.ts";
import type { App } from "./app.ts";
import { PATIENCE } from "./patience.ts";
import { machinePixels } from "./pixels.ts";

/** So far inside and outside of its edge the ring of a state is looked for, in CSS pixels. */
const NEAR = 3;

/** A colour of the theme, as its variable is called. */
export type Tone = "running" | "waiting" | "held" | "aborted" | "preempted" | "canvas-trail";

/** Waits until the ring around a state has a colour. */
export async function ringed(app: App, path: string, tone: Tone): Promise<void> {
  await vi.waitUntil(async () => ((await ringPart(app, path, tone)) ?? 0) > 0.3, PATIENCE);
}

/** Waits until the ring around a state has none of this colour any more. */
export async function unringed(app: App, path: string, tone: Tone): Promise<void> {
  await vi.waitUntil(async () => {
    const part = await ringPart(app, path, tone);
    return part !== null && part < 0.05;
  }, PATIENCE);
}

/** The part of the middle third of a state's lower edge that has the colour; null of a state out of sight. */
async function ringPart(app: App, path: string, tone: Tone): Promise<number | null> {
  const box = await app.box(path);
  const around = {
    x: Math.round(box.x) - NEAR,
    y: Math.round(box.y) - NEAR,
    width: Math.round(box.width) + 2 * NEAR,
    height: Math.round(box.height) + 2 * NEAR,
  };
  if (!isInSight(app, around)) return null;
  return coloured(app, await machinePixels(app, around), tone, around);
}

function isInSight(app: App, { x, y, width, height }: Box): boolean {
  const size = app.sheet.viewportSize();
  return size !== null && x >= 0 && y >= 0 && x + width <= size.width && y + height <= size.height;
}

/** How much of the middle of the lower edge shows the colour, faded or not, within a few pixels of where the edge is. */
async function coloured(app: App, png: string, tone: Tone, { width }: Box): Promise<number> {
  const [url, name, near, columns] = [png, `--${tone}`, NEAR, width];
  return app.sheet.evaluate(
    async (asked) => {
      const picture = new Image();
      picture.src = asked.url;
      await picture.decode();
      const context = new OffscreenCanvas(picture.width, picture.height).getContext("2d");
      if (!context) throw new Error("the browser cannot create a canvas to read the picture");
      context.drawImage(picture, 0, 0);
      const { data } = context.getImageData(0, 0, picture.width, picture.height);
      const canvas = document.querySelector("[role=application]") ?? document.body;
      const number = Number.parseInt(
        getComputedStyle(canvas).getPropertyValue(asked.name).trim().slice(1),
        16,
      );
      const wanted = [number >> 16, (number >> 8) & 255, number & 255];
      const isLike = (x: number, y: number) =>
        wanted.every((part, index) => {
          const found = data[(y * picture.width + x) * 4 + index] ?? 0;
          return Math.abs(found - part) < 28;
        });
      const rows = Array.from({ length: 2 * asked.near + 1 }, (_, row) => row);
      let found = 0;
      const [from, until] = [Math.floor(asked.columns / 3), Math.floor((2 * asked.columns) / 3)];
      for (let x = from; x < until; x++) {
        const below = rows.some((row) => isLike(x, picture.height - 1 - row));
        if (below) found += 1;
      }
      return found / Math.max(1, until - from);
    },
    { url, name, near, columns },
  );
}
