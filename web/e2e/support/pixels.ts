/** What the canvas really shows: where on the screen the edges of a box are, by its pixels. */

import type { Box } from "../../src/model/geometry.ts";
import type { App } from "./app.ts";

/** So many CSS pixels around a box are looked at too. */
export const AROUND = 8;

/** The box that stands out of its surroundings here. Ports reach over edges: what most rows and most columns show counts. */
export async function boxShown(app: App, expected: Box): Promise<Box> {
  const [x, y] = [Math.round(expected.x) - AROUND, Math.round(expected.y) - AROUND];
  const width = Math.round(expected.width) + 2 * AROUND;
  const height = Math.round(expected.height) + 2 * AROUND;
  const png = await app.sheet.screenshot({ clip: { x, y, width, height } });
  const found = await edges(app, png);
  return { x: x + found.x, y: y + found.y, width: found.width, height: found.height };
}

/** A part of the picture of the machine, as text. What stands over it, such as messages, their shadows and pulses, is not in it. */
export async function machinePixels(app: App, part: Box): Promise<string> {
  return app.canvas.evaluate((root, { x, y, width, height }) => {
    const picture = root.querySelector("canvas");
    if (!picture) throw new Error("the machine has no picture");
    const place = picture.getBoundingClientRect();
    const scale = picture.width / place.width;
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [width * scale, height * scale];
    const context = copy.getContext("2d");
    if (!context) throw new Error("there is no canvas to copy the picture to");
    context.drawImage(picture, (place.x - x) * scale, (place.y - y) * scale);
    return copy.toDataURL();
  }, part);
}

/** The first and last pixels of a picture that are unlike its left upper corner: the middle one of all rows, and of all columns. */
async function edges(app: App, png: Buffer): Promise<Box> {
  return app.sheet.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (sign) => sign.charCodeAt(0));
    const picture = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const { width, height } = picture;
    const context = new OffscreenCanvas(width, height).getContext("2d");
    if (!context) throw new Error("the browser cannot create a canvas to read the picture");
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, width, height);
    const colour = (x: number, y: number) =>
      data.slice((y * width + x) * 4, (y * width + x) * 4 + 3).join();
    const ground = colour(0, 0);
    const numbers = (count: number) => Array.from({ length: count }, (_, index) => index);
    const middle = (found: number[]) => found.sort((a, b) => a - b)[found.length >> 1] ?? -1;
    /** From the first to the last that is unlike the ground, of the middle line. */
    const span = (lines: number, length: number, at: (along: number, line: number) => string) => {
      const unlike = numbers(lines)
        .map((line) => numbers(length).filter((along) => at(along, line) !== ground))
        .filter((line) => line.length > 0);
      const first = middle(unlike.map((line) => line[0] ?? -1));
      return { first, count: middle(unlike.map((line) => line.at(-1) ?? -1)) - first + 1 };
    };
    const across = span(height, width, colour);
    const down = span(width, height, (y, x) => colour(x, y));
    return { x: across.first, y: down.first, width: across.count, height: down.count };
  }, png.toString("base64"));
}
