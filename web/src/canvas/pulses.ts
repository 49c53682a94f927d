/** Pulse on a taken transition: a light that runs along the line. It has a canvas of its own, so that the picture is not
 * repainted. There is no pulse for users who prefer reduced motion, nor after many transitions at once, which would only flicker. */

import { effect, type ReadonlySignal } from "@preact/signals-core";
import type { ElementKey } from "../model/element.ts";
import type { Watch } from "../store/history/run.ts";
import { inkOf } from "./paint/ink.ts";
import type { CanvasPicture } from "./picture.ts";
import type { SceneInput } from "./scene/input.ts";

const DURATION_MS = 420;
/** Largest number of transitions since the last check that still pulse. */
const AT_ONCE = 6;
/** Length and width of the light, in CSS pixels. */
const LENGTH = 34;
const WIDTH = 5;

interface RunningPulse {
  readonly points: readonly number[];
  readonly begun: number;
}

interface Pulses {
  readonly dispose: () => void;
}

export function pulsesOver(
  place: HTMLElement,
  picture: CanvasPicture,
  run: ReadonlySignal<Watch | null>,
): Pulses {
  const canvas = document.createElement("canvas");
  canvas.style.cssText = "position:absolute;inset:0;width:100%;height:100%;pointer-events:none";
  canvas.setAttribute("aria-hidden", "true");
  place.append(canvas);
  const still = window.matchMedia("(prefers-reduced-motion: reduce)");
  const news = new NewlyTaken();
  let fresh: readonly string[] = [];
  let pulses: readonly RunningPulse[] = [];
  let frame = 0;

  const step = () => {
    frame = 0;
    const now = performance.now();
    pulses = pulses.filter(({ begun }) => now - begun < DURATION_MS);
    paintPulses(canvas, picture, pulses, now);
    if (pulses.length > 0) frame = requestAnimationFrame(step);
  };
  const stopFollowing = effect(() => {
    const watch = run.value;
    const found = news.of(watch, picture.taken());
    fresh = still.matches || !watch || isPast(watch) ? [] : found;
  });
  const stopFrames = picture.onFrame(() => {
    if (fresh.length === 0) return;
    const begun = performance.now();
    const lines = linesOf(picture, fresh);
    fresh = [];
    pulses = [...pulses, ...lines.map((points) => ({ points, begun }))];
    if (frame === 0 && pulses.length > 0) frame = requestAnimationFrame(step);
  });
  return {
    dispose: () => {
      cancelAnimationFrame(frame);
      stopFollowing();
      stopFrames();
      canvas.remove();
    },
  };
}

/** True if the transitions are old: the history of the run is still loading, or the run is over and no earlier moment is selected. */
function isPast({ isCaughtUp, playhead, now }: Watch): boolean {
  return !isCaughtUp.value || (playhead.value === null && now.value?.link === "over");
}

/** Transitions taken since the last check. */
export class NewlyTaken {
  #run: unknown = null;
  #last: number | null = null;

  /** Empty on the first check of a run, and if there are too many. */
  of(run: unknown, all: SceneInput["taken"]): readonly ElementKey[] {
    const before = run === this.#run ? this.#last : null;
    const taken = [...all].filter(([, { isNext }]) => !isNext);
    this.#run = run;
    this.#last = taken.reduce((most, [, { sequence }]) => Math.max(most, sequence), before ?? 0);
    const found = taken.filter(([, { sequence }]) => before !== null && sequence > before);
    return found.length > AT_ONCE ? [] : found.map(([key]) => key);
  }
}

/** Painted lines of these transitions. */
function linesOf(picture: CanvasPicture, keys: readonly string[]): readonly (readonly number[])[] {
  const wanted = new Set(keys);
  return picture
    .list()
    .layers.flatMap(({ lines }) => lines.filter(({ what }) => wanted.has(what)))
    .map(({ points }) => points);
}

function paintPulses(
  canvas: HTMLCanvasElement,
  picture: CanvasPicture,
  pulses: readonly RunningPulse[],
  now: number,
): void {
  const { width, height } = picture.size();
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
  const context = canvas.getContext("2d");
  if (!context) return;
  context.clearRect(0, 0, width, height);
  context.strokeStyle = inkOf(picture.colours(), "running");
  context.lineCap = "round";
  context.lineJoin = "round";
  context.lineWidth = WIDTH;
  for (const { points, begun } of pulses) {
    const part = (now - begun) / DURATION_MS;
    const end = part * (lengthOf(points) + LENGTH);
    context.globalAlpha = 0.9 * (1 - part ** 3);
    context.beginPath();
    stretch(context, points, end - LENGTH, end);
    context.stroke();
  }
}

export function lengthOf(points: readonly number[]): number {
  let length = 0;
  for (let at = 2; at < points.length; at += 2) length += pieceLength(points, at);
  return length;
}

function pieceLength(points: readonly number[], at: number): number {
  const [fromX = 0, fromY = 0, toX = 0, toY = 0] = points.slice(at - 2, at + 2);
  return Math.hypot(toX - fromX, toY - fromY);
}

/** Adds the part of a line between two distances from its start to the path. */
export function stretch(
  path: Pick<CanvasPath, "moveTo" | "lineTo">,
  points: readonly number[],
  from: number,
  to: number,
): void {
  let before = 0;
  for (let at = 2; at < points.length; at += 2) {
    const length = pieceLength(points, at);
    const [start, end] = [Math.max(from, before), Math.min(to, before + length)];
    if (length > 0 && end > start) {
      const [x = 0, y = 0, toX = 0, toY = 0] = points.slice(at - 2, at + 2);
      const on = (distance: number) => (distance - before) / length;
      path.moveTo(x + (toX - x) * on(start), y + (toY - y) * on(start));
      path.lineTo(x + (toX - x) * on(end), y + (toY - y) * on(end));
    }
    before += length;
  }
}
