/** Ports on the border of a state: dots that show the direction, and their names where there is room. */

import { keyOf } from "../../model/element.ts";
import type { JsonValue, StateDocument } from "../../model/generated/protocol.ts";
import { type Point, sideOf } from "../../model/geometry.ts";
import type { PortPlace } from "../../model/layout_reader.ts";
import { ABORTED, type PortKind, PREEMPTED, portsOf } from "../../model/machine.ts";
import { python } from "../../model/value.ts";
import type { SceneBuilder, SceneNode } from "./builder.ts";
import { isClear, isOffLines, PLATE } from "./connections.ts";
import { DETAIL, fade, TEXT } from "./detail.ts";
import type { ValueChip } from "./input.ts";
import type { DotShape, Ink } from "./list.ts";
import { groundInk } from "./ring.ts";
import { cut } from "./words.ts";

/** Ports with a transition. */
type ConnectedPorts = ReadonlySet<string>;

export function portMarks(
  builder: SceneBuilder,
  node: SceneNode,
  connected: ConnectedPorts,
  open: boolean,
): void {
  const alpha = fade(node.extent, DETAIL.ports);
  const named = fade(node.extent, DETAIL.labels);
  if (alpha === 0 && !builder.focused.has(node.at.path)) return;
  const layer = builder.layer(node.depth);
  const size = node.extent >= DETAIL.labels ? 10 : node.extent >= 110 ? 8 : 6;
  const taken: TakenNames = { left: [], right: [], top: [], bottom: [] };
  for (const port of node.at.ports) {
    if (!isShown(builder, node, port, connected)) continue;
    const [x, y] = [node.x + port.at.x * node.scale, node.y + port.at.y * node.scale];
    if (!builder.sees(x, y, 0, 0, 240)) continue;
    const side = sideOf(port.at, node.at.size);
    layer.dots.push({
      what: port.key,
      shape: SHAPES[port.kind],
      x,
      y,
      size,
      ...direction(port, side),
      fill: portInk(port),
      stroke: outlineOf(builder, port),
      alpha: Math.max(alpha, builder.focused.has(node.at.path) ? 1 : 0),
    });
    if (port.kind === "income") continue;
    const place = { x, y, side, alpha: named, open, size };
    // The transition shows the name of a connected outcome until the port does.
    const isOnLine = port.kind === "outcome" && connected.has(port.key);
    if (named > 0) largeWords(builder, node, port, place, taken);
    else if (!isOnLine) smallWords(builder, node, port, { ...place, alpha }, taken);
    pointedWords(builder, port, place);
  }
}

export const SHAPES: Readonly<Record<PortPlace["kind"], DotShape>> = {
  income: "income",
  outcome: "outcome",
  input: "data",
  output: "data",
  scoped_variable: "scoped",
};

function isShown(
  builder: SceneBuilder,
  node: SceneNode,
  port: PortPlace,
  connected: ConnectedPorts,
): boolean {
  const isQuiet = port.kind === "outcome" && (port.id === ABORTED || port.id === PREEMPTED);
  if (!isQuiet || builder.input.modes.aborted) return true;
  return (
    builder.focused.has(node.at.path) || connected.has(port.key) || node.at.joined.has(port.key)
  );
}

/** Colour of a port, and of a line that starts there. */
export function portInk(port: Pick<PortPlace, "kind" | "id">): Ink {
  if (port.kind === "income") return "income";
  if (port.kind !== "outcome") return "data";
  return port.id === ABORTED ? "aborted" : port.id === PREEMPTED ? "preempted" : "outcome";
}

function outlineOf(builder: SceneBuilder, port: PortPlace): Ink | null {
  if (builder.isSelected(port.key)) return "selection";
  if (builder.highlighted.has(port.key)) return "highlight";
  const difference = builder.input.differences.get(port.key);
  if (difference) return difference;
  const legal = builder.input.overlay.targets.get(port.key);
  return legal === undefined ? null : legal ? "legal" : "illegal";
}

type PortSide = ReturnType<typeof sideOf>;
type TakenNames = Record<PortSide, number[]>;

const OUT = {
  left: { toX: -1, toY: 0 },
  right: { toX: 1, toY: 0 },
  top: { toX: 0, toY: -1 },
  bottom: { toX: 0, toY: 1 },
} as const;

/** Direction of the dot: incomes and inputs point inwards. */
function direction(
  port: PortPlace,
  side: PortSide,
): { readonly toX: number; readonly toY: number } {
  const { toX, toY } = OUT[side];
  return port.kind === "income" || port.kind === "input" ? { toX: -toX, toY: -toY } : { toX, toY };
}

/** Name with the value, or the name alone beside states inside; with names hidden, the value. */
function largeWords(
  builder: SceneBuilder,
  node: SceneNode,
  port: PortPlace,
  place: WordsPlace,
  taken: TakenNames,
): void {
  const { modes, values } = builder.input;
  const value = valueText(builder, node, port, values.get(port.key));
  const whole = wordsOf(builder, port, value);
  const isNameAlone = modes.portNames && value !== null && !hasRoom(builder, node, place, whole);
  const text = isNameAlone ? port.name : whole;
  const room = isUpright(place.side) ? node.width * 0.42 : 150;
  if (text !== "") label(builder, node, port, { ...place, text, room }, taken);
}

/** Name with the value of the run if both fit. A name without a value is drawn only if all of it fits. */
function smallWords(
  builder: SceneBuilder,
  node: SceneNode,
  port: PortPlace,
  place: WordsPlace,
  taken: TakenNames,
): void {
  const chip = node.extent >= CHIPS ? builder.input.values.get(port.key) : undefined;
  const text = wordsOf(builder, port, chip?.short ?? null);
  const fits = text !== "" && fitsWhole(builder, node, place, text);
  if (chip) {
    const room = fits ? node.width : node.width * 0.42;
    const words = { alpha: 1, open: true, text: fits ? text : chip.short, room };
    label(builder, node, port, { ...place, ...words }, taken);
  } else if (fits && place.alpha > 0) {
    const words = { text, room: node.width, isSpare: true };
    label(builder, node, port, { ...place, ...words }, taken);
  }
}

/** Full value at the hovered port. */
function pointedWords(builder: SceneBuilder, port: PortPlace, { x, y }: WordsPlace): void {
  const chip = builder.input.values.get(port.key);
  if (chip && isHovered(builder, port)) builder.pointed = { x, y, text: chip.full };
}

/** True if a text fits into a small state and covers no state inside. */
function fitsWhole(
  builder: SceneBuilder,
  node: SceneNode,
  { x, y, side, open, size }: WordsPlace,
  text: string,
): boolean {
  const width = builder.input.measure(text, TEXT.small, false);
  const away = awayFrom(size);
  if (isUpright(side)) {
    const middle = x + (side === "left" ? 1 : -1) * (away + width / 2);
    if (width + 2 * away > node.width) return false;
    return !open || isClear(node, { x: middle, y }, width, PLATE);
  }
  if (x - width / 2 < node.x + 4 || x + width / 2 > node.x + node.width - 4) return false;
  return !open || isClear(node, { x, y: rowBelow(side, y, size) }, width, PLATE);
}

/** True if a text covers no state inside. Values must not cover states. */
function hasRoom(
  builder: SceneBuilder,
  node: SceneNode,
  { x, y, side, open }: WordsPlace,
  text: string,
): boolean {
  if (!open || !isUpright(side)) return true;
  const width = builder.input.measure(text, TEXT.small, false) + 16;
  return isClear(node, { x: side === "left" ? x + width / 2 : x - width / 2, y }, width);
}

/** Place of a port and of its text. */
interface WordsPlace {
  readonly x: number;
  readonly y: number;
  readonly side: PortSide;
  readonly alpha: number;
  readonly open: boolean;
  readonly size: number;
}

interface LabelPlace extends WordsPlace {
  readonly text: string;
  /** Maximum width; longer texts are cut. */
  readonly room: number;
  /** True if labels and names of larger states take precedence. */
  readonly isSpare?: boolean;
}

function isUpright(side: PortSide): boolean {
  return side === "left" || side === "right";
}

/** Distance between the centre of a port and its text. */
function awayFrom(size: number): number {
  return size / 2 + 5;
}

/** Row of the text at a port in the upper or lower border. */
function rowBelow(side: PortSide, y: number, size: number): number {
  const away = awayFrom(size) + 5;
  return side === "top" ? y + away : y - away;
}

const ROW = 14;

/** Name inside the border. Beside other names it needs a free row. */
function label(
  builder: SceneBuilder,
  node: SceneNode,
  port: PortPlace,
  place: LabelPlace,
  taken: TakenNames,
): void {
  const { side } = place;
  const isBeside = isUpright(side);
  const text = cut(place.text, place.room, TEXT.small, false, builder.input.measure);
  const width = builder.input.measure(text, TEXT.small, false);
  const along = isBeside ? place.y : place.x;
  const apart = isBeside ? ROW : width + 8;
  if (text === "" || taken[side].some((other) => Math.abs(other - along) < apart)) return;
  taken[side].push(along);
  const away = awayFrom(place.size);
  const align = side === "left" ? "left" : side === "right" ? "right" : "center";
  const inwards = side === "left" ? away : -away;
  const beside = { x: place.x + inwards, y: place.y };
  const [x, y] = isBeside
    ? [
        beside.x,
        rowOf(
          builder,
          node,
          port,
          place,
          { ...beside, x: beside.x + (Math.sign(inwards) * width) / 2 },
          width,
        ),
      ]
    : [place.x, rowBelow(side, place.y, place.size)];
  const names = place.isSpare ? builder.smallPortNames : builder.portNames;
  names.push({
    what: `${port.key} name`,
    x,
    y,
    text,
    size: TEXT.small,
    bold: false,
    ink: labelInk(port),
    align,
    alpha: place.alpha,
    plate: place.open ? groundInk(node) : null,
    width,
  });
}

/** Vertical offsets that a name may take to avoid a line. */
const ASIDE = [0, -12, 12, -20, 20];

/** Height at which no transition runs through the name of a container's outcome: level with the port, above or below. */
function rowOf(
  builder: SceneBuilder,
  node: SceneNode,
  port: PortPlace,
  { open, y }: LabelPlace,
  middle: Point,
  width: number,
): number {
  if (!open || port.kind !== "outcome" || !builder.input.modes.transitions) return y;
  const rows = ASIDE.map((aside) => y + aside);
  const isFree = (row: number) => {
    const at = { x: middle.x, y: row };
    return isOffLines(node, at, width) && (row === y || isClear(node, at, width, PLATE));
  };
  return rows.find(isFree) ?? y;
}

/** Characters of a value that are shown. */
const VALUE = 14;

/** Smallest state that shows the values at its ports before there is room for names, in CSS pixels. */
const CHIPS = 110;

function isHovered({ input: { hovered } }: SceneBuilder, port: PortPlace): boolean {
  return hovered !== null && keyOf(hovered) === port.key;
}

/** Name and value, as far as both are switched on. */
function wordsOf({ input }: SceneBuilder, { name }: PortPlace, value: string | null): string {
  if (!input.modes.portNames) return value ?? "";
  return value === null ? name : `${name} = ${value}`;
}

/** Value of the run, or else the preset; null without one. */
function valueText(
  builder: SceneBuilder,
  { at }: SceneNode,
  port: PortPlace,
  chip: ValueChip | undefined,
): string | null {
  if (!builder.input.modes.values) return null;
  if (chip) return chip.short;
  const hasPreset = port.kind === "input" || port.kind === "scoped_variable";
  // During a run only actual values are shown: a default may not have been used.
  if (!hasPreset || builder.input.runs.size > 0) return null;
  const value = presetOf(at.state, port.kind, port.id);
  if (value === undefined || value === null) return null;
  const text = python(value);
  return text.length > VALUE ? `${text.slice(0, VALUE - 1)}…` : text;
}

/** Preset of a port: set by the library state, or its default. */
function presetOf(state: StateDocument, kind: PortKind, id: number): JsonValue | undefined {
  const set = state.library?.inputs?.find((value) => value.port === id && value.used);
  return set ? set.value : portsOf(state, kind).find((port) => port.id === id)?.default;
}

function labelInk(port: PortPlace): Ink {
  if (port.kind !== "outcome") return "data-text";
  return port.id === ABORTED ? "aborted" : port.id === PREEMPTED ? "preempted" : "soft";
}
