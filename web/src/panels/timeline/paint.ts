/** Paints the timeline: rows of bars, and above them the ruler with its marks. */

import type { Inks } from "../../store/canvas_element.ts";
import type { Calls } from "../../store/history/calls.ts";
import type { CallLook } from "../../store/history/lanes.ts";
import { NOTE_KINDS, type NoteKind, type Notes } from "../../store/history/notes.ts";
import type { Gap } from "../../store/run/gaps.ts";
import type { RunSearch } from "../../store/run/search.ts";
import type { NameOf } from "../parts/happened.ts";
import { type Bar, barsOf, NARROW_PX, type Scale, xOf } from "./bars.ts";
import { ROW_PX, type TimelineLayout } from "./layout.ts";
import { ticks } from "./span.ts";

export interface Scene {
  readonly calls: Calls;
  readonly notes: Notes;
  readonly found: RunSearch | null;
  readonly layout: TimelineLayout;
  readonly scale: Scale;
  /** Scroll position of the rows, in CSS pixels. */
  readonly top: number;
  readonly height: number;
  /** Time of the shown moment; null while live. */
  readonly shown_ns: number | null;
  /** Sequence number of the current hit. */
  readonly hit: number | null;
  readonly selected: ReadonlySet<string>;
  readonly hovered: number | null;
  /** Time at which the shown run differs from another run. */
  readonly parted_ns: number | null;
  /** Times without data from the server. */
  readonly gaps: readonly Gap[];
  readonly nameOf: NameOf;
  /** Formats a time with the precision of this step. */
  readonly timeOf: (t_ns: number, step_ms: number) => string;
  readonly inks: Inks;
  readonly font: string;
}

export const RULER_PX = 40;
const NOTES_Y = 30;

const LOOKS: Readonly<Record<CallLook, { readonly ink: string; readonly sign: string }>> = {
  open: { ink: "--running", sign: "" },
  ended: { ink: "--canvas-trail", sign: "" },
  aborted: { ink: "--aborted", sign: "✕ " },
  preempted: { ink: "--preempted", sign: "⊘ " },
  back: { ink: "--text-faint", sign: "↶ " },
  dropped: { ink: "--waiting", sign: "⇥ " },
};

export function paintRows(context: CanvasRenderingContext2D, scene: Scene): void {
  const { layout, scale, top, height, inks } = scene;
  context.fillStyle = inks("--sunken");
  context.fillRect(0, 0, scale.width, height);
  context.font = `11px ${scene.font}`;
  context.textBaseline = "middle";
  paintTicks(context, scene);
  for (const { rows, y: laneY, height: laneHeight } of layout.lanes) {
    if (laneY + laneHeight < top || laneY > top + height) continue;
    for (const { row, y } of rows) {
      if (y + ROW_PX < top || y > top + height) continue;
      for (const bar of barsOf(scene.calls, row, scale)) paintBar(context, scene, bar, y - top);
    }
    context.fillStyle = inks("--border");
    context.fillRect(0, laneY + laneHeight - top + 2.5, scale.width, 1);
  }
  paintGaps(context, scene, 0, height);
  paintPlayhead(context, scene, height);
}

const HATCH_PX = 7;

/** Hatches times without live data. Their events arrived later, or are still missing. */
function paintGaps(
  context: CanvasRenderingContext2D,
  { gaps, scale, inks }: Scene,
  top: number,
  height: number,
): void {
  context.strokeStyle = inks("--text-faint");
  context.lineWidth = 1;
  for (const { from_ns, to_ns } of gaps) {
    const left = Math.max(0, xOf(scale, from_ns));
    const right = Math.min(scale.width, xOf(scale, to_ns ?? scale.end_ns));
    if (right < 0 || left > scale.width) continue;
    context.save();
    context.globalAlpha = 0.5;
    context.beginPath();
    context.rect(left, top, Math.max(2, right - left), height);
    context.clip();
    context.beginPath();
    for (let x = left - height; x < right; x += HATCH_PX) {
      context.moveTo(x, top + height);
      context.lineTo(x + height, top);
    }
    context.stroke();
    context.restore();
  }
}

function paintTicks(context: CanvasRenderingContext2D, { scale, height, inks }: Scene): void {
  context.fillStyle = inks("--border");
  context.globalAlpha = 0.45;
  for (const at of ticks(scale.span, scale.width / 90).at_ns) {
    context.fillRect(Math.round(xOf(scale, at)), 0, 1, height);
  }
  context.globalAlpha = 1;
}

function paintBar(context: CanvasRenderingContext2D, scene: Scene, bar: Bar, y: number): void {
  const { inks } = scene;
  const top = y + 1;
  const height = ROW_PX - 3;
  const together = togetherIn(bar);
  if (together) {
    const { many, failed } = together;
    context.fillStyle = inks(failed > 0 ? "--aborted" : "--canvas-trail");
    context.globalAlpha = many > 1 ? 0.85 : 0.65;
    context.fillRect(bar.x, failed > 0 ? top : top + 3, bar.width, height - (failed > 0 ? 0 : 3));
    context.globalAlpha = 1;
    return;
  }
  const { path, look, isHovered } = aloneIn(scene, bar);
  const left = Math.max(-4, bar.x);
  const right = Math.min(scene.scale.width + 4, bar.x + bar.width);
  const width = Math.max(1, right - left - (bar.width > 4 ? 1 : 0));
  const { ink, sign } = LOOKS[look];
  context.fillStyle = inks(ink);
  context.globalAlpha = look === "open" ? 0.38 : 0.24;
  context.fillRect(left, top, width, height);
  context.globalAlpha = 1;
  paintEdge(context, look, { left, top, width, height });
  if (scene.selected.has(path) || isHovered) {
    context.strokeStyle = inks(isHovered ? "--text-soft" : "--canvas-selection");
    context.lineWidth = 1.5;
    context.strokeRect(left + 0.75, top + 0.75, Math.max(1, width - 1.5), height - 1.5);
  }
  paintName(context, scene, `${sign}${scene.nameOf(path)}`, {
    left: Math.max(0, left),
    width: right - Math.max(0, left),
    y: top + height / 2 - 0.5,
  });
}

/** Number of merged calls and failures of a bar; null for a single call. */
function togetherIn(bar: Bar): { readonly many: number; readonly failed: number } | null {
  if (!("seen" in bar)) return "many" in bar ? bar : null;
  return bar.seen.many > 1 || bar.width <= NARROW_PX ? bar.seen : null;
}

interface AloneBar {
  readonly path: string;
  readonly look: CallLook;
  readonly isHovered: boolean;
}

function aloneIn({ calls, hovered }: Scene, bar: Bar): AloneBar {
  if ("seen" in bar) return { path: bar.seen.path, look: bar.seen.look, isHovered: false };
  if ("many" in bar) return { path: calls.path(bar.first), look: "ended", isHovered: false };
  return { path: calls.path(bar.call), look: bar.look, isHovered: hovered === bar.call };
}

interface Rect {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
}

/** Edge of a bar, which shows the end of the call by its shape: dashed if undone or interrupted, with a block at the end if
 * aborted, with a line on top if preempted. */
function paintEdge(context: CanvasRenderingContext2D, look: CallLook, rect: Rect): void {
  const { left, top, width, height } = rect;
  const y = top + height - 2;
  if (look === "back" || look === "dropped") {
    for (let x = left; x < left + width; x += 6) {
      context.fillRect(x, y, Math.min(3, left + width - x), 2);
    }
    return;
  }
  context.fillRect(left, y, width, 2);
  if (look === "aborted")
    context.fillRect(left + width - Math.min(3, width), top, Math.min(3, width), height);
  if (look === "preempted") context.fillRect(left, top, width, 1);
}

const NARROWEST_TEXT = 28;
const PADDING = 4;

function paintName(
  context: CanvasRenderingContext2D,
  { inks }: Scene,
  text: string,
  { left, width, y }: { readonly left: number; readonly width: number; readonly y: number },
): void {
  const room = width - 2 * PADDING;
  if (room < NARROWEST_TEXT) return;
  context.fillStyle = inks("--text");
  context.fillText(cut(context, text, room), left + PADDING, y);
}

/** Text, cut to the available width. */
function cut(context: CanvasRenderingContext2D, text: string, room: number): string {
  const wide = context.measureText(text).width;
  if (wide <= room) return text;
  const kept = Math.max(1, Math.floor((text.length * room) / wide) - 1);
  return `${text.slice(0, kept)}…`;
}

/** Dims everything after the shown moment, and draws a line at the moment. */
function paintPlayhead(context: CanvasRenderingContext2D, scene: Scene, height: number): void {
  const { scale, shown_ns, inks, parted_ns } = scene;
  if (parted_ns !== null) {
    context.fillStyle = inks("--changed");
    for (let y = 0; y < height; y += 7) {
      context.fillRect(Math.round(xOf(scale, parted_ns)) - 1, y, 2, 4);
    }
  }
  if (shown_ns === null) {
    context.fillStyle = inks("--running");
    context.fillRect(Math.round(xOf(scale, scale.end_ns)), 0, 1, height);
    return;
  }
  const x = Math.round(xOf(scale, shown_ns));
  context.fillStyle = inks("--sunken");
  context.globalAlpha = 0.4;
  context.fillRect(x, 0, Math.max(0, scale.width - x), height);
  context.globalAlpha = 1;
  context.fillStyle = inks("--accent");
  context.fillRect(x - 1, 0, 2, height);
}

export function paintRuler(context: CanvasRenderingContext2D, scene: Scene): void {
  const { scale, inks } = scene;
  context.fillStyle = inks("--surface");
  context.fillRect(0, 0, scale.width, RULER_PX);
  context.font = `11px ${scene.font}`;
  context.textBaseline = "middle";
  const { step_ms, at_ns } = ticks(scale.span, scale.width / 90);
  for (const at of at_ns) {
    const x = Math.round(xOf(scale, at));
    context.fillStyle = inks("--border-strong");
    context.fillRect(x, 14, 1, 6);
    context.fillStyle = inks("--text-soft");
    const words = scene.timeOf(at, step_ms);
    const isWhole = x + 4 + context.measureText(words).width <= scale.width;
    if (isWhole) context.fillText(words, x + 4, 9);
  }
  context.fillStyle = inks("--border");
  context.fillRect(0, RULER_PX - 1, scale.width, 1);
  paintGaps(context, scene, 20, RULER_PX - 20);
  paintHits(context, scene);
  paintNotes(context, scene);
  paintFlag(context, scene);
}

function paintHits(context: CanvasRenderingContext2D, { found, scale, hit, inks }: Scene): void {
  if (!found) return;
  context.fillStyle = inks("--canvas-hit");
  let last = Number.NEGATIVE_INFINITY;
  for (let place = 0; place < found.count; place += 1) {
    const x = xOf(scale, found.t_ns(place));
    if (x < 0 || x > scale.width || x - last < 2) continue;
    last = x;
    context.fillRect(Math.round(x) - 1, 20, 2, 4);
  }
  if (hit === null) return;
  const x = xOf(scale, found.t_ns(found.after(hit - 1)));
  triangle(context, x, 16, 6);
}

const NOTE_INKS: Readonly<Record<NoteKind, string>> = {
  command: "--accent",
  edit: "--changed",
  question: "--waiting",
  breakpoint: "--held",
  back: "--text-faint",
  warning: "--warning",
  error: "--danger",
  crash: "--danger",
};

/** Symbol of each kind, for users who cannot distinguish the colours. */
const NOTE_SIGNS: Readonly<Record<NoteKind, string>> = {
  command: "›",
  edit: "±",
  question: "?",
  breakpoint: "●",
  back: "↶",
  warning: "▲",
  error: "✕",
  crash: "☇",
};

const NOTE_PX = 10;

function paintNotes(context: CanvasRenderingContext2D, { notes, scale, inks }: Scene): void {
  const { journal } = notes;
  const shown = new Map<number, NoteKind>();
  const until = notes.firstFrom(journal.indexAt(scale.span.to_ns + 1));
  for (let at = notes.firstFrom(journal.indexAt(scale.span.from_ns)); at < until; at++) {
    const note = notes.all[at];
    if (!note) continue;
    const slot = Math.floor(xOf(scale, journal.t_ns(note.index)) / NOTE_PX);
    const before = shown.get(slot);
    if (!before || NOTE_KINDS.indexOf(before) < NOTE_KINDS.indexOf(note.kind))
      shown.set(slot, note.kind);
  }
  context.textAlign = "center";
  for (const [slot, kind] of shown) {
    context.fillStyle = inks(NOTE_INKS[kind]);
    context.fillText(NOTE_SIGNS[kind], slot * NOTE_PX + NOTE_PX / 2, NOTES_Y);
  }
  context.textAlign = "start";
}

function paintFlag(context: CanvasRenderingContext2D, { scale, shown_ns, inks }: Scene): void {
  const t_ns = shown_ns ?? scale.end_ns;
  context.fillStyle = inks(shown_ns === null ? "--running" : "--accent");
  triangle(context, xOf(scale, t_ns), RULER_PX - 2, 7);
}

/** Triangle that points down to `y`. */
function triangle(context: CanvasRenderingContext2D, x: number, y: number, size: number): void {
  context.beginPath();
  context.moveTo(x - size * 0.8, y - size);
  context.lineTo(x + size * 0.8, y - size);
  context.lineTo(x, y);
  context.fill();
}
