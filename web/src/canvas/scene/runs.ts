/** Run marks on a state, as colour, shape and text: rings, a glow on active states, a hatch, a sign, and a plate with the
 * duration and the number of visits. */

import type { Point } from "../../model/geometry.ts";
import { STEPS } from "../../store/history/recent_path.ts";
import { sinceStart } from "../../store/page/times.ts";
import type { MarkPhase, RunMark } from "../../store/run/marks.ts";
import type { SceneBuilder, SceneNode } from "./builder.ts";
import { DETAIL, TEXT } from "./detail.ts";
import type { SignPlace } from "./labels.ts";
import type { BoxMark, Icon, IconMark, Ink, Layer, TextMark } from "./list.ts";
import { groundInk, ring } from "./ring.ts";

export const RUN_INKS: Readonly<Record<Exclude<MarkPhase, "inside">, Ink>> = {
  running: "running",
  waiting: "waiting",
  held: "held",
  next: "held",
  failed: "aborted",
  preempted: "preempted",
  trail: "trail",
};

const ICONS: Readonly<Partial<Record<MarkPhase, Icon>>> = {
  running: "running",
  waiting: "waiting",
  held: "held",
  next: "next",
  failed: "failed",
  preempted: "preempted",
};

const WORDS: Readonly<Partial<Record<MarkPhase, string>>> = {
  running: "running",
  waiting: "waits",
  held: "paused",
  next: "next",
  failed: "failed",
  preempted: "preempted",
};

/** Smallest state with a plate, in CSS pixels. */
const PLATE = 80;
/** Smallest state with rings, in CSS pixels; smaller boxes are filled. */
const FILLED = DETAIL.name;
const ICON = 12;

const WANTS: ReadonlySet<MarkPhase> = new Set(["waiting", "held"]);

export function runMarks(
  builder: SceneBuilder,
  node: SceneNode,
  mark: RunMark,
  isOpen: boolean,
): void {
  const layer = builder.layer(node.depth);
  const phase = isOpen ? mark.phase : closedPhase(mark);
  const hasFailed = phase !== "failed" && (isOpen ? mark.failed : mark.mostUrgent === "failed");
  if (phase === "inside") {
    visitMarks(builder, node);
    return;
  }
  if (phase === "trail") trailMarks(layer, node, mark);
  else if (node.extent < FILLED) smallMarks(layer, node, phase, hasFailed);
  else {
    ringMarks(layer, node, phase, mark.isLeaf);
    if (hasFailed) layer.boxes.push(ring(node, "aborted", 2, 4, whatOf(node)));
    if (phase === "preempted") hatchMarks(builder, layer, node);
  }
  if (node.extent < FILLED) return;
  const side = signMarks(builder, layer, node, phase, { ...mark, failed: hasFailed });
  plateMarks(
    builder,
    node,
    wordsOf(phase, { ...mark, failed: hasFailed }, builder.input.sinceSnapshot_ms),
    side,
  );
}

/** Phase of a state with hidden content: the most urgent one inside. An earlier failure does not hide an active or waiting state. */
export function closedPhase(mark: RunMark): MarkPhase {
  const { phase, mostUrgent, mostUrgentActive, since_ms, isLeaf } = mark;
  if (isLeaf) return phase;
  return mostUrgent === "failed" && since_ms !== null ? mostUrgentActive : mostUrgent;
}

/** Plate with the number of visits, for states without other run marks. */
export function visitMarks(builder: SceneBuilder, node: SceneNode): void {
  if (node.extent < PLATE || builder.input.visits(node.at.path) === 0) return;
  plateMarks(builder, node, [], 0);
}

function whatOf(node: SceneNode): string {
  return `${node.at.key} run`;
}

/** Opacity, which decreases with every step. */
export function faded(age: number): number {
  return Math.max(0.25, 1 - (0.8 * age) / STEPS);
}

function trailMarks(layer: Layer, node: SceneNode, { age, preempted }: RunMark): void {
  const ink = preempted ? "preempted" : "trail";
  const mark = ring(node, ink, node.extent < FILLED ? 1.5 : 2, 0, whatOf(node));
  layer.boxes.push({
    ...mark,
    alpha: faded(age),
    dash: preempted,
    fill: node.extent < FILLED ? ink : null,
  });
}

/** Mark of a state too small for signs: filled, dashed or hollow, depending on the phase. */
function smallMarks(
  layer: Layer,
  node: SceneNode,
  phase: Exclude<MarkPhase, "inside" | "trail">,
  hasFailed: boolean,
): void {
  const ink = RUN_INKS[phase];
  const mark = ring(node, ink, 2, 0, whatOf(node));
  const isFull = phase === "running" || phase === "failed";
  layer.boxes.push({
    ...mark,
    // A state that waits for a person takes precedence over an earlier failure.
    ...(hasFailed && !WANTS.has(phase) ? { stroke: "aborted" } : {}),
    fill: isFull ? ink : null,
    dash: phase === "waiting" || phase === "next",
  });
  if (phase !== "failed" || node.extent < 12) return;
  const middle = { x: node.x + node.width / 2, y: node.y + node.height / 2 };
  layer.icons.push(sign(node, "failed", "ground", middle));
}

const RINGS = {
  running: { line: 3, dash: false },
  waiting: { line: 2.5, dash: true },
  held: { line: 3, dash: false },
  next: { line: 2, dash: true },
  failed: { line: 3, dash: false },
  preempted: { line: 2, dash: true },
} as const;

/** Ring of a state in a run. It is thin around other active states. Innermost active, waiting or failed states glow. */
function ringMarks(
  layer: Layer,
  node: SceneNode,
  phase: Exclude<MarkPhase, "inside" | "trail">,
  isLeaf: boolean,
): void {
  const ink = RUN_INKS[phase];
  const { line, dash } = RINGS[phase];
  const isQuiet = phase === "running" && !isLeaf;
  const glows = isLeaf && phase !== "next" && phase !== "preempted";
  if (glows) layer.boxes.push(...GLOW.map((part) => glow(node, ink, part)));
  const mark = ring(node, ink, isQuiet ? 2 : line, 0, whatOf(node));
  layer.boxes.push({ ...mark, dash });
}

const GLOW = [
  { line: 4, away: 3.5, alpha: 0.3 },
  { line: 5, away: 7, alpha: 0.14 },
] as const;

function glow(node: SceneNode, ink: Ink, { line, away, alpha }: (typeof GLOW)[number]): BoxMark {
  return { ...ring(node, ink, line, away, `${whatOf(node)} glow`), alpha };
}

const HATCH = 9;
const HATCH_MAX = 90;

/** Diagonal lines over the visible part of the state. */
function hatchMarks(builder: SceneBuilder, layer: Layer, node: SceneNode): void {
  const left = Math.max(node.x, 0);
  const top = Math.max(node.y, 0);
  const width = Math.min(node.x + node.width, builder.width) - left;
  const height = Math.min(node.y + node.height, builder.height) - top;
  if (width <= 0 || height <= 0) return;
  const step = Math.max(HATCH, (width + height) / HATCH_MAX);
  for (let along = step; along < width + height; along += step) {
    const [fromX, toX] = [Math.min(along, width), Math.max(0, along - height)];
    layer.under.push({
      what: `${whatOf(node)} hatch`,
      points: [left + fromX, top + along - fromX, left + toX, top + along - toX],
      ink: "preempted",
      width: 1,
      radius: 0,
      curve: false,
      arrow: 0,
      dash: false,
      alpha: 0.45,
    });
  }
}

function sign(node: SceneNode, icon: Icon, ink: Ink, { x, y }: Point): IconMark {
  return { what: `${whatOf(node)} ${icon}`, icon, x, y, size: ICON, ink, alpha: 1 };
}

/** Plate behind a sign on the corner of a state, where the sign does not cover the name. */
function coin(node: SceneNode, { x, y }: Point): TextMark {
  return {
    what: `${whatOf(node)} coin`,
    x,
    y,
    text: "",
    size: TEXT.small,
    bold: false,
    ink: "text",
    align: "center",
    alpha: 1,
    plate: groundInk(node),
    width: 9,
  };
}

/** Distance between two signs. */
const SIGN_PITCH = ICON + 3;

/** Signs of a state, with the number of active branches inside; returns their width. Those of a small state are at a corner
 * without text, those of others in the upper right. */
function signMarks(
  builder: SceneBuilder,
  layer: Layer,
  node: SceneNode,
  phase: MarkPhase,
  mark: RunMark,
): number {
  const icon = ICONS[phase];
  if (!icon) return 0;
  const ink = RUN_INKS[phase as Exclude<MarkPhase, "inside">];
  const signs: readonly (readonly [Icon, Ink])[] = mark.failed
    ? [
        [icon, ink],
        ["failed", "aborted"],
      ]
    : [[icon, ink]];
  /** From right to left. */
  const from = ({ x, y }: Point) =>
    signs.map(([each, colour], index) =>
      sign(node, each, colour, { x: x - index * SIGN_PITCH, y }),
    );
  if (node.extent < PLATE) {
    const places = corners(node, (signs.length - 1) * SIGN_PITCH).map((at) => ({
      texts: [coin(node, at)],
      icons: from(at),
    }));
    builder.signs.push({ layer, places });
  } else layer.icons.push(...from({ x: node.x + node.width - 10, y: node.y + 10 }));
  if (mark.lanes > 1 && node.width >= 48) {
    builder.signs.push({
      layer,
      places: lanesPlaces(builder, node, mark.lanes, ink, signs.length),
    });
  }
  return ICON;
}

/** Places of the rightmost sign of a small state. */
function corners({ x, y, width, height }: SceneNode, more: number): readonly Point[] {
  const [left, right, bottom] = [x + 3 + more, x + width - 3, y + height];
  return [
    { x: right, y },
    { x: right, y: bottom },
    { x: left, y: bottom },
    { x: left, y },
  ];
}

/** Places of the number of active branches: to the left of the signs, or below them. */
function lanesPlaces(
  builder: SceneBuilder,
  node: SceneNode,
  lanes: number,
  ink: Ink,
  signs: number,
): readonly SignPlace[] {
  const isSmall = node.extent < PLATE;
  const right = node.x + node.width - (isSmall ? 3 : 10);
  const top = node.y + (isSmall ? 0 : 10);
  const beside = { x: right - (signs - 1) * SIGN_PITCH - ICON / 2 - 4, y: top };
  const text = `${lanes}`;
  return [beside, { x: right + ICON / 2, y: top + SIGN_PITCH }].map((at) => ({
    icons: [],
    texts: [
      {
        what: `${whatOf(node)} lanes`,
        ...at,
        text,
        size: TEXT.small,
        bold: true,
        ink,
        align: "right",
        alpha: 1,
        plate: groundInk(node),
        width: builder.input.measure(text, TEXT.small, true),
      },
    ],
  }));
}

/** Texts for the plate, from the most detailed to the shortest. */
function wordsOf(
  phase: MarkPhase,
  { since_ms, detail, failed }: RunMark,
  sinceSnapshot_ms: number,
): readonly string[] {
  const word = WORDS[phase] ?? "";
  const seconds = since_ms === null ? 0 : Math.floor((since_ms + sinceSnapshot_ms) / 1_000);
  const time = seconds < 1 ? "" : sinceStart(seconds * 1_000, 1_000);
  const more = detail === null ? word : `${word}: ${detail}`;
  const also = failed ? "failed" : "";
  return [[also, more, time], [also, word, time], [word, time], [time], [word]].map((parts) =>
    parts.filter((part) => part !== "").join(" · "),
  );
}

/** Plate at the lower edge, with the longest text that fits. */
function plateMarks(
  builder: SceneBuilder,
  node: SceneNode,
  words: readonly string[],
  side: number,
): void {
  if (node.extent < PLATE) return;
  const { measure, visits } = builder.input;
  const count = visits(node.at.path);
  const times = count > 0 ? `${count.toLocaleString("en")}×` : "";
  const room = node.width - 16 - (side > 0 ? 4 : 0);
  const wanted = [...words.map((text) => joined(text, times)), times];
  const text = wanted.find((each) => measure(each, TEXT.small, false) <= room);
  if (!text) return;
  builder.labels.push({
    what: `${whatOf(node)} plate`,
    x: node.x + node.width - 8,
    y: node.y + node.height - 11,
    text,
    size: TEXT.small,
    bold: false,
    ink: words.length > 0 ? "text" : "soft",
    align: "right",
    alpha: 1,
    plate: groundInk(node),
    width: measure(text, TEXT.small, false),
  });
}

function joined(text: string, times: string): string {
  return text === "" || times === "" ? text + times : `${text} · ${times}`;
}
