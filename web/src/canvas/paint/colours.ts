/** Colours of the canvas: maps the names of inks to the colours of the theme. */

import { HEAT_LEVELS } from "../scene/input.ts";

/** Colours by the names of inks. */
export type Colours = Readonly<Record<string, string>>;

/** Inks that are a variable of the page's theme. */
const VARIABLES: Readonly<Record<string, string>> = {
  ground: "--canvas-ground",
  outline: "--canvas-outline",
  "library-ground": "--canvas-library",
  "library-outline": "--canvas-library-outline",
  line: "--canvas-line",
  "aborted-line": "--canvas-aborted-line",
  "preempted-line": "--canvas-preempted-line",
  flow: "--canvas-flow",
  outcome: "--canvas-outcome",
  income: "--canvas-outcome",
  grid: "--canvas-grid",
  ghost: "--canvas-ghost",
  band: "--canvas-ghost",
  drop: "--canvas-drop",
  selection: "--canvas-selection",
  hover: "--canvas-hover",
  highlight: "--canvas-highlight",
  hit: "--canvas-hit",
  trail: "--canvas-trail",
  text: "--text",
  soft: "--text-soft",
  data: "--canvas-data",
  "data-text": "--data",
  aborted: "--aborted",
  preempted: "--preempted",
  running: "--running",
  waiting: "--waiting",
  held: "--held",
  breakpoint: "--breakpoint",
  added: "--added",
  removed: "--removed",
  changed: "--changed",
  legal: "--success",
  illegal: "--danger",
  guide: "--accent",
  handle: "--surface",
  good: "--raised",
  "on-good": "--text",
  bad: "--danger-soft",
  "on-bad": "--text",
  "on-person": "--canvas-on-person",
  person0: "--canvas-person-0",
  person1: "--canvas-person-1",
  person2: "--canvas-person-2",
  person3: "--canvas-person-3",
  person4: "--canvas-person-4",
  person5: "--canvas-person-5",
};

const DEPTHS = 10;

/** Colours as in the current styles of an element. */
export function coloursOf(element: Element): Colours {
  const style = getComputedStyle(element);
  const colours: Record<string, string> = {};
  for (const [ink, variable] of Object.entries(VARIABLES)) {
    colours[ink] = style.getPropertyValue(variable).trim() || "#888888";
  }
  const outer = style.getPropertyValue("--canvas-state");
  const inner = style.getPropertyValue("--canvas-state-deep");
  const [cold, hot] = [
    style.getPropertyValue("--canvas-heat-low"),
    style.getPropertyValue("--canvas-heat-high"),
  ];
  for (let level = 0; level <= HEAT_LEVELS; level++) {
    colours[`heat${level}`] = mixed(cold, hot, level / HEAT_LEVELS);
  }
  for (const [depth, colour] of shades(outer, inner).entries()) colours[`shade${depth}`] = colour;
  return colours;
}

/** Background of states by depth: from one `#rrggbb` towards another, in decreasing steps. */
export function shades(outer: string, inner: string): readonly string[] {
  return Array.from({ length: DEPTHS }, (_, depth) => mixed(outer, inner, 1 - 0.72 ** depth));
}

/** Colour between two `#rrggbb`; `part` is from 0 to 1. */
function mixed(outer: string, inner: string, part: number): string {
  const [from, to] = [rgb(outer), rgb(inner)];
  const colour = from.map((value, index) =>
    Math.round(value + ((to[index] ?? value) - value) * part),
  );
  return `#${colour.map((value) => value.toString(16).padStart(2, "0")).join("")}`;
}

/** Red, green and blue of `#rrggbb`. */
function rgb(colour: string): readonly number[] {
  const number = Number.parseInt(colour.trim().slice(1), 16);
  return Number.isNaN(number) ? [128, 128, 128] : [number >> 16, (number >> 8) & 255, number & 255];
}
