/** What is measured, and what was promised of it. */

export const BARS = {
  frame_750_median_ms: 8,
  frame_750_p95_ms: 16,
  frame_10000_median_ms: 12,
  frame_10000_p95_ms: 25,
  open_750_ms: 1_000,
  open_10000_ms: 2_000,
  edit_to_picture_ms: 16,
  undo_10000_ms: 40,
  redo_10000_ms: 40,
  presented_750_median_ms: 33,
  presented_10000_median_ms: 33,
  memory_growth_percent: 10,
  live_1000_frame_median_ms: 8,
  live_1000_frame_p95_ms: 16,
  live_1000_presented_median_ms: 33,
  live_1000_age_ms: 150,
  ten_million_open_s: 1,
  ten_million_page_mb: 300,
} as const;

export type Figure = keyof typeof BARS;

export type Figures = Readonly<Record<Figure, number>>;

/** One JSON object a line. */
export function asLines(figures: Figures): string {
  const lines = Object.entries(figures).map(([name, value]) =>
    JSON.stringify({ name, value: rounded(value) }),
  );
  return `${lines.join("\n")}\n`;
}

/** For people: figure, value, bar, and whether it holds. */
export function asTable(figures: Figures): string {
  const rows = Object.entries(BARS).map(([name, bar]) => {
    const value = figures[name as Figure];
    const verdict = value <= bar ? "ok" : "MISSED";
    return `${name.padEnd(28)}${String(rounded(value)).padStart(10)}   at most ${String(bar).padStart(5)}   ${verdict}`;
  });
  return `${rows.join("\n")}\n`;
}

/** As it is printed. */
export function rounded(value: number): number {
  return Math.round(value * 100) / 100;
}
