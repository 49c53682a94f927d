/** Plot of a watched value over the time of the run. All plots share one cursor. A click sets the shown moment. */

import { useEffect, useRef, useState } from "react";
import type uPlot from "uplot";
import { onTheme } from "../../store/canvas_element.ts";
import type { SeriesPoint } from "../../store/history/series.ts";
import { useSignal } from "../../ui/signals.ts";
import { duration } from "../parts/duration.ts";
import "uplot/dist/uPlot.min.css";
import type { ShownValue } from "./watched_value.ts";

const HEIGHT_PX = 92;
const LINE_PX = 1;

export function Plot({ watched }: { watched: ShownValue }) {
  const place = useRef<HTMLDivElement>(null);
  const { history, watch, name } = watched;
  const points = history.series.points;
  const changed = useSignal(history.changed);
  const playhead = useSignal(watch.playhead);
  const journalVersion = useSignal(watch.journalVersion);
  const plot = useRef<uPlot | null>(null);
  const [isMissing, setMissing] = useState(false);
  const latest = useRef({ watched, playhead });
  latest.current = { watched, playhead };
  useEffect(() => {
    const home = place.current;
    if (!home) return;
    let isGone = false;
    let tidy = () => {};
    const made = (drawn: uPlot) => {
      if (isGone) return drawn.destroy();
      plot.current = drawn;
      drawn.setData(dataOf(latest.current.watched));
      drawn.over.addEventListener("click", () => show(drawn, latest.current));
      tidy = follow(home, drawn);
    };
    draw(home, () => latest.current).then(made, () => setMissing(true));
    return () => {
      isGone = true;
      tidy();
      plot.current?.destroy();
      plot.current = null;
    };
  }, []);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the series is mutable; the two counters change with it
  useEffect(() => plot.current?.setData(dataOf(watched)), [watched, changed, journalVersion]);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the line of the moment is read when it is drawn
  useEffect(() => plot.current?.redraw(false), [playhead]);
  if (isMissing) {
    return <p className="watches-refusal">The plot did not load. Reload the page.</p>;
  }
  return (
    <div
      ref={place}
      className="watches-plot"
      role="img"
      aria-label={`${name} over time: ${points.length} points`}
    />
  );
}

interface Latest {
  readonly watched: ShownValue;
  readonly playhead: number | null;
}

/** Creates the plot. Its library is loaded on first use. */
async function draw(home: HTMLElement, latest: () => Latest): Promise<uPlot> {
  const { default: Made } = await import("uplot");
  const colour = (name: string) => () => getComputedStyle(home).getPropertyValue(name).trim();
  const axis = {
    stroke: colour("--text-faint"),
    ticks: { show: false },
    font: "10px Inter Variable",
  };
  const grid = { stroke: colour("--border"), width: LINE_PX };
  const stepped = Made.paths.stepped?.({ align: 1 });
  return new Made(
    {
      width: Math.max(60, home.clientWidth),
      height: HEIGHT_PX,
      legend: { show: false },
      padding: [6, 8, 0, 0],
      cursor: {
        sync: { key: "rafcon watches" },
        drag: { x: false, y: false },
        points: { size: 6 },
      },
      scales: { x: { time: false } },
      axes: [
        { ...axis, grid, size: 20, values: (_, ticks) => ticks.map((s) => duration(s * 1_000)) },
        { ...axis, grid, size: 44 },
      ],
      series: [
        {},
        {
          stroke: colour("--accent"),
          width: 1.5,
          points: { show: false },
          ...(stepped ? { paths: stepped } : {}),
        },
      ],
      hooks: {
        draw: [(plot) => drawPlayhead(plot, latest(), colour("--data")())],
        setCursor: [(plot) => tell(home, plot, latest())],
      },
    },
    dataOf(latest().watched),
    home,
  );
}

/** Shows the value under the cursor as text. */
function tell(home: HTMLElement, plot: uPlot, { watched }: Latest): void {
  const point = pointAt(plot, watched.history.series.points);
  const words = point ? `${point.value} at ${duration(point.t_ns / 1e6)}` : "";
  const output = home.parentElement?.querySelector(".watches-cursor-value");
  if (output) output.textContent = words;
}

function show(plot: uPlot, { watched }: Latest): void {
  const point = pointAt(plot, watched.history.series.points);
  if (point) watched.watch.playhead.value = point.sequence;
}

/** Last point at or before the cursor. */
function pointAt(plot: uPlot, points: readonly SeriesPoint[]): SeriesPoint | null {
  const left = plot.cursor.left ?? -1;
  if (left < 0) return null;
  const t_ns = plot.posToVal(left, "x") * 1e9;
  const after = points.findIndex((point) => point.t_ns > t_ns);
  return points[after < 0 ? points.length - 1 : Math.max(0, after - 1)] ?? null;
}

/** Times in seconds, and values. The last value is extended to the end of the journal. */
function dataOf({ history, watch }: ShownValue): uPlot.AlignedData {
  const { points } = history.series;
  const { journal } = watch;
  const times = points.map(({ t_ns }) => t_ns / 1e9);
  const values: (number | null)[] = points.map(({ value }) =>
    Number.isFinite(value) ? value : null,
  );
  const end = journal.length === 0 ? 0 : journal.t_ns(journal.length - 1) / 1e9;
  if (times.length > 0 && end > (times.at(-1) ?? 0)) {
    times.push(end);
    values.push(values.at(-1) ?? null);
  }
  return [times, values];
}

function drawPlayhead(plot: uPlot, { watched, playhead }: Latest, colour: string): void {
  if (playhead === null) return;
  const { window: journal } = watched.watch;
  const x = plot.valToPos(journal.t_ns(journal.indexOf(playhead)) / 1e9, "x", true);
  const { left, top, width, height } = plot.bbox;
  if (x < left || x > left + width) return;
  const { ctx } = plot;
  ctx.save();
  ctx.strokeStyle = colour;
  ctx.lineWidth = 2 * devicePixelRatio;
  ctx.beginPath();
  ctx.moveTo(x, top);
  ctx.lineTo(x, top + height);
  ctx.stroke();
  ctx.restore();
}

/** Keeps the plot as wide as its container, and in the colours of the theme. */
function follow(home: HTMLElement, plot: uPlot): () => void {
  const sizes = new ResizeObserver(() => {
    if (home.clientWidth > 0) plot.setSize({ width: home.clientWidth, height: HEIGHT_PX });
  });
  sizes.observe(home);
  const stopTheme = onTheme(() => plot.redraw());
  return () => {
    sizes.disconnect();
    stopTheme();
  };
}
