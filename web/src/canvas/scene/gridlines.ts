/** Grid lines on the background of the innermost container around the view, as an optional drawing aid. */

import type { SceneBuilder } from "./builder.ts";
import type { LineMark } from "./list.ts";

/** Smallest distance between lines, in CSS pixels. */
const PITCH = 24;

export function ruledMarks(builder: SceneBuilder): void {
  const { camera, modes } = builder.input;
  if (!modes.grid) return;
  const depth = builder.covering?.depth ?? 0;
  const { under } = builder.layer(depth + 1);
  const step = stepFor(camera.scale) * camera.scale;
  const rest = (from: number) => (((-from * camera.scale) % step) + step) % step;
  for (let x = rest(camera.x); x < builder.width; x += step) {
    under.push(ruled([x, 0, x, builder.height]));
  }
  for (let y = rest(camera.y); y < builder.height; y += step) {
    under.push(ruled([0, y, builder.width, y]));
  }
}

/** Units of the root between two lines: one, two or five times a power of ten. */
export function stepFor(scale: number): number {
  const least = PITCH / scale;
  const ten = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((times) => times * ten).find((step) => step >= least) ?? 10 * ten;
}

function ruled(points: readonly number[]): LineMark {
  return {
    what: "grid",
    points,
    ink: "grid",
    width: 1,
    radius: 0,
    curve: false,
    arrow: 0,
    dash: false,
    alpha: 0.6,
  };
}
