/** What a long watch is asked for, and what was promised of it. */

import { parseArgs } from "node:util";
import { rounded } from "./figures.ts";

export interface Wanted {
  readonly seconds: number;
  /** So many states change in a second. */
  readonly rate: number;
  /** Seconds between two looks at the memory. */
  readonly every: number;
  readonly json: boolean;
}

const FIGURES = [
  "events",
  "events_per_second",
  "differences",
  "page_growth_percent",
  "browser_growth_percent",
  "page_mb",
  "browser_mb",
  "frame_median_ms",
  "frame_p95_ms",
  "presented_median_ms",
] as const;

type Figure = (typeof FIGURES)[number];

/** What a figure is not to exceed. */
const BARS: Partial<Record<Figure, number>> = {
  differences: 0,
  page_growth_percent: 10,
  browser_growth_percent: 10,
  frame_median_ms: 8,
  frame_p95_ms: 16,
  presented_median_ms: 33,
};

/** Whoever watches for less than this does not see memory grow, and has no computer of their own for the frames. */
const SHORT_SECONDS = 180;

export function asked(words: readonly string[]): Wanted {
  const { values } = parseArgs({
    args: [...words],
    options: {
      seconds: { type: "string", default: "600" },
      rate: { type: "string", default: "20" },
      every: { type: "string", default: "10" },
      json: { type: "boolean", default: false },
    },
  });
  const [seconds, rate, every] = [values.seconds, values.rate, values.every].map(Number);
  if (!seconds || !rate || !every) throw new Error("--seconds, --rate, --every: numbers above 0");
  return { seconds, rate, every, json: values.json };
}

/** Prints them, and says whether what counts holds: of a short watch, that every event came once. */
export function printed(wanted: Wanted, figures: Readonly<Record<Figure, number>>): boolean {
  for (const name of FIGURES) {
    const value = rounded(figures[name]);
    process.stdout.write(wanted.json ? `${JSON.stringify({ name, value })}\n` : row(name, value));
  }
  const counts: readonly Figure[] = wanted.seconds < SHORT_SECONDS ? ["differences"] : FIGURES;
  return counts.every((name) => isKept(name, figures[name]));
}

function row(name: Figure, value: number): string {
  const bar = BARS[name];
  const verdict = isKept(name, value) ? "ok" : "MISSED";
  const promised = bar === undefined ? "" : `   at most ${String(bar).padStart(5)}   ${verdict}`;
  return `${name.padEnd(28)}${String(value).padStart(10)}${promised}\n`;
}

function isKept(name: Figure, value: number): boolean {
  const bar = BARS[name];
  return bar === undefined || value <= bar;
}
